/** A diagnosis as a page: verdict, where, what, how much, how sure, what next. */
import { percent, plain, power, words } from "../format";
import { saveFile } from "../plan/downloads";
import { Bars } from "./bars";
import { FindingCard } from "./finding_card";
import type { Difference, Report } from "./report";
import { accept, again } from "./state";
import { TimeAxis } from "./time_axis";
import { DriveMap } from "./drive_map";

const VERDICTS: Record<Report["verdict"], { name: string; about: string }> = {
  consistent: { name: "Consistent", about: "The model describes the drives." },
  explained: { name: "Explained", about: "What was missing is named, and nothing else that is known explains it as well." },
  ambiguous: { name: "Ambiguous", about: "It is one of several that these drives cannot tell apart." },
  unexplained: { name: "Unexplained", about: "Something is missing that no known mechanism describes." },
};

export function ReportPage({ report }: { report: Report }) {
  const { name, about } = VERDICTS[report.verdict];
  const hasPositions = report.trace?.position_m.some((at) => at !== null) ?? false;
  return (
    <article class="report">
      <header class="verdict" data-verdict={report.verdict}>
        <p class="verdict-name">{name}</p>
        <h2>{report.sentence}</h2>
        <p>{about}</p>
        <Acts report={report} />
      </header>
      <section class="card" aria-label="Errors before and after">
        <h3>How far off, before and after</h3>
        <Bars report={report} />
      </section>
      {report.where.length > 0 && (
        <section class="card" aria-label="Where they differ">
          <h3>Where</h3>
          <ul class="where">
            {report.where.map((place) => (
              <Where key={place.statement} place={place} />
            ))}
          </ul>
        </section>
      )}
      {report.trace && <TimeAxis trace={report.trace} where={report.where} />}
      {report.trace && hasPositions && <DriveMap trace={report.trace} where={report.where} />}
      {report.findings.map((finding) => (
        <FindingCard key={finding.mechanism} finding={finding} />
      ))}
      {report.next_drive && (
        <section class="card next-drive" aria-label="Next drive">
          <h3>The drive that would tell</h3>
          <p>{report.next_drive}</p>
        </section>
      )}
      {report.notes.length > 0 && (
        <section class="card" aria-label="Notes">
          <h3>Keep in mind</h3>
          <ul>
            {report.notes.map((note) => (
              <li key={note}>{note}</li>
            ))}
          </ul>
        </section>
      )}
      <Seen report={report} />
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

/** What would have been seen, and what could not. */
function Seen({ report }: { report: Report }) {
  if (report.detectable.length + report.not_judged.length === 0) return null;
  return (
    <details class="card seen">
      <summary>What else was looked for</summary>
      {report.detectable.length > 0 && (
        <>
          <p>These would have been noticed from the size given; noise alone is {power(report.baseline.noise_floor_w)}.</p>
          <ul class="detectable">
            {report.detectable.map(({ mechanism, parameter, value, unit }) => (
              <li key={mechanism + parameter}>
                <span>{words(mechanism)}</span>
                <span class="number">
                  {plain(value)} {unit === "1" ? "" : unit}
                </span>
              </li>
            ))}
          </ul>
        </>
      )}
      {report.not_judged.length > 0 && <p>These drives tell nothing of {report.not_judged.map(words).join(", ")}.</p>}
    </details>
  );
}
