/** A diagnosis as a page: verdict, error of the robot's file, explanations, findings, errors before and after, places, what next. */
import { useState } from "preact/hooks";
import { percent, plain, power } from "../format";
import { saveFile } from "../plan/downloads";
import { Bars } from "./bars";
import { Explanations } from "./explanations";
import { FileError } from "./file_error";
import { FindingCard } from "./finding_card";
import { capitalized, mechanismLabel } from "./labels";
import type { Difference, Report } from "./report";
import { accept, again } from "./state";
import { ErrorsOverTime } from "./time_axis";
import { DriveMap } from "./drive_map";
import { shadedOf } from "./windows";

const VERDICTS: Record<Report["verdict"], { name: string; about: string }> = {
  consistent: { name: "Consistent", about: "The model describes these drives." },
  explained: { name: "Explained", about: "The missing effect is identified." },
  ambiguous: { name: "Ambiguous", about: "These drives cannot distinguish a few explanations." },
  unexplained: { name: "Unexplained", about: "The list of mechanisms does not settle what is missing." },
};

export function ReportPage({ report }: { report: Report }) {
  const { name, about } = VERDICTS[report.verdict];
  const { trace } = report;
  const [run, showRun] = useState(trace?.run[0] ?? 0);
  const where = shadedOf(report);
  const shown = trace ? { trace, where, run, showRun } : null;
  const hasPositions = trace?.position_m.some((at) => at !== null) ?? false;
  return (
    <article class="report">
      <header class="verdict" data-verdict={report.verdict}>
        <p class="verdict-name">{name}</p>
        <h2>{report.sentence}</h2>
        <p>{about}</p>
        <Acts report={report} />
      </header>
      <FileError report={report} shown={shown} />
      <Explanations report={report} />
      {report.findings.map((finding, i) => (
        <FindingCard key={finding.mechanism + i} finding={finding} />
      ))}
      <section class="card time-axis" aria-label="Errors before and after">
        <h3>Errors before and after</h3>
        <Bars report={report} />
        {shown && <ErrorsOverTime {...shown} />}
      </section>
      {report.where.length > 0 && (
        <section class="card" aria-label="Where they differ">
          <h3>Where they differ</h3>
          <ul class="where">
            {report.where.map((place) => (
              <Where key={place.statement} place={place} />
            ))}
          </ul>
        </section>
      )}
      {trace && hasPositions && <DriveMap trace={trace} where={where} />}
      {report.next_drive && (
        <section class="card next-drive" aria-label="Next drive">
          <h3>Next drive</h3>
          <p>To decide, {report.next_drive}.</p>
        </section>
      )}
      <Seen report={report} />
      {report.notes.length > 0 && (
        <section class="card" aria-label="Notes">
          <h3>Notes</h3>
          <ul>
            {report.notes.map((note) => (
              <li key={note}>{note}</li>
            ))}
          </ul>
        </section>
      )}
    </article>
  );
}

function Acts({ report }: { report: Report }) {
  return (
    <div class="verdict-acts">
      <button type="button" class="primary" onClick={() => void accept(report)}>
        Accept the corrected robot and plan with it
      </button>
      <button
        type="button"
        onClick={() => saveFile(new Blob([JSON.stringify(report, null, 2)], { type: "application/json" }), "report.json")}
      >
        Download the report
      </button>
      <button type="button" onClick={again}>
        Another diagnosis
      </button>
    </div>
  );
}

function Where({ place }: { place: Difference }) {
  return (
    <li>
      <span class="where-kind">{place.kind}</span>
      <span>{place.statement}</span>
      <span class="where-share">
        <i style={{ width: `${100 * Math.min(place.share_of_excess, 1)}%` }} />
      </span>
      <span class="number">{percent(place.share_of_excess)} of the difference</span>
    </li>
  );
}

/** The sizes that these drives would have shown, and what is not identifiable from them. */
function Seen({ report }: { report: Report }) {
  if (report.detectable.length + report.not_judged.length === 0) return null;
  return (
    <details class="card seen" open={report.verdict === "consistent"}>
      <summary>Sensitivity of these drives</summary>
      {report.detectable.length > 0 && (
        <>
          <p>Least size of each other mechanism that would have been noticed; noise is {power(report.baseline.noise_floor_w)}.</p>
          <ul class="detectable">
            {report.detectable.map(({ mechanism, parameter, value, unit }) => (
              <li key={mechanism + parameter}>
                <span>{capitalized(mechanismLabel(mechanism))}</span>
                <span class="number">
                  {plain(value)} {unit === "1" ? "" : unit}
                </span>
              </li>
            ))}
          </ul>
        </>
      )}
      {report.not_judged.length > 0 && <p>Not identifiable from these drives: {report.not_judged.map(mechanismLabel).join(", ")}.</p>}
    </details>
  );
}
