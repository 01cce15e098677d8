/** Recordings that were dropped, and what reading each found. */
import { useEffect, useState } from "preact/hooks";
import { listRecordings, readRecording, type RecordingSummary, type ReadingReport } from "../api/recordings";
import { problemOf } from "../api/problem";
import { bytes, duration, plain, words } from "../format";
import { DropZone } from "../widgets/drop_zone";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { channelOf } from "../columns/channels";
import { ColumnPicker } from "../columns/column_picker";
import * as plan from "../plan/state";
import { alike, job, leave, problem, readAs, robotId, take, taken, takeStored, use, type Role, type Taken } from "./state";

const ENDINGS = ".csv,.tsv,.txt,.gz,.zst,.parquet,.mcap,.db3,.bag,.ulg";

/** The refusal of a file that has no column or topic for what is needed. */
const UNKNOWN_COLUMNS = /is missing; found:|reads none of them/;

const POWER_FORMS: Record<string, string> = {
  sides: "both sides",
  battery: "the battery",
  current_and_voltage: "current and voltage",
  motor_currents: "motor currents",
};

const ROLES: { role: Role; name: string; label: string; about: string }[] = [
  {
    role: "suspect",
    name: "Suspect drives",
    label: "Drop the suspect drives here",
    about: "CSV, Parquet, MCAP, .db3 or .bag, two minutes of driving at least",
  },
  {
    role: "healthy",
    name: "Healthy drives",
    label: "Drop healthy drives here",
    about: "Optional: the same robot when all was well. Makes it far sharper",
  },
];

/** Drop zones for the given roles. Alone, the suspect drives are simply the drives. */
export function Recordings({ roles }: { roles: Role[] }) {
  const isAlone = roles.length === 1;
  const shown = isAlone ? [{ ...ROLES[0]!, label: "Drop drives here", name: "Drives" }] : ROLES;
  return (
    <div class="recordings" data-alone={isAlone}>
      {shown.map(({ role, label, about, name }) => (
        <section key={role} aria-label={name}>
          <DropZone label={label} accept={ENDINGS} isMany take={(files) => take(files, role)}>
            <span>{about}</span>
          </DropZone>
          <Stored role={role} />
          {taken.value
            .filter((one) => one.role === role)
            .map((one) => (
              <Card key={one.key} one={one} />
            ))}
        </section>
      ))}
    </div>
  );
}

/** Recordings that the service has already. */
function Stored({ role }: { role: Role }) {
  const [all, setAll] = useState<RecordingSummary[]>([]);
  useEffect(() => {
    listRecordings().then(setAll, () => setAll([]));
  }, [job.value, taken.value.length]);
  const others = all.filter(({ id }) => !taken.value.some((one) => one.recording?.id === id));
  if (others.length === 0) return null;
  const choose = (id: string) => {
    if (id)
      readRecording(id).then(
        (recording) => takeStored(recording, role),
        (thrown) => (problem.value = problemOf(thrown)),
      );
  };
  return (
    <select class="stored" aria-label={`A stored recording as ${role}`} value="" onChange={(event) => choose(event.currentTarget.value)}>
      <option value="">or a stored one…</option>
      {others.map(({ id, runs, rows, format, bytes: size }) => (
        <option key={id} value={id}>
          {runs.slice(0, 2).join(", ")}
          {runs.length > 2 ? ", …" : ""} · {format} · {rows.toLocaleString("en")} rows · {bytes(size)}
        </option>
      ))}
    </select>
  );
}

function Card({ one }: { one: Taken }) {
  const [isPicking, setPicking] = useState(false);
  const { columns, problem: refusal, recording } = one;
  // A file whose columns are not known is for whoever has it to explain.
  const isUnknown = refusal !== undefined && UNKNOWN_COLUMNS.test(refusal.document.detail);
  return (
    <article class="recording">
      <header>
        {recording && (
          <input
            type="checkbox"
            aria-label={`Use ${one.name}`}
            title="Use it"
            checked={one.isUsed}
            onChange={(event) => use(one.key, event.currentTarget.checked)}
          />
        )}
        <b>{one.name}</b>
        <small>{bytes(one.bytes)}</small>
        <button type="button" class="quiet" aria-label={`Leave ${one.name} out`} title="Leave it out" onClick={() => leave(one.key)}>
          ×
        </button>
      </header>
      {refusal && !(isUnknown && columns) && <ProblemCard problem={refusal} />}
      {!one.problem && !one.recording && (
        <Progress label={one.share < 1 ? "Sending" : "Reading"} share={one.share < 1 ? one.share : null} />
      )}
      {recording && <Reading report={recording.report} />}
      {columns && (refusal || recording) && !isUnknown && !isPicking && (
        <button type="button" onClick={() => setPicking(true)}>
          Say what its columns are…
        </button>
      )}
      {columns && (isPicking || isUnknown) && (
        <ColumnPicker
          columns={columns}
          isUnknown={isUnknown}
          before={one.map}
          others={alike(one.key).length - 1}
          robotId={robotId.value ?? plan.robotId.value}
          take={(map) => {
            setPicking(false);
            readAs(one.key, map);
          }}
        />
      )}
    </article>
  );
}

function Reading({ report }: { report: ReadingReport }) {
  const seconds = report.runs.reduce((sum, run) => sum + run.duration_s, 0);
  const rate_hz = report.runs[0]?.rate_hz;
  const warnings = [
    ...report.suspicions.map((doubt) => ({ what: words(doubt.channel), why: doubt.statement })),
    ...report.repairs.map(({ place, what }) => ({ what: place, why: what })),
    ...report.ignored.map(({ name, reason }) => ({ what: name, why: reason })),
    ...report.aside.map((name) => ({ what: name, why: "kept aside: its name says no known channel" })),
  ];
  return (
    <>
      <dl class="facts">
        <Fact name="Rows" value={report.rows.toLocaleString("en")} />
        <Fact name="Drives" value={String(report.runs.length)} />
        <Fact name="Time" value={duration(seconds)} />
        <Fact name="Rate" value={rate_hz ? `${plain(rate_hz)} Hz` : "–"} />
        <Fact name="Power by" value={POWER_FORMS[report.power_form ?? ""] ?? "nothing"} />
      </dl>
      {warnings.length > 0 ? (
        <ul class="warnings">
          {warnings.map(({ what, why }, i) => (
            <li key={i}>
              <b>{what}</b> {why}
            </li>
          ))}
        </ul>
      ) : (
        <p class="fine">Nothing suspicious.</p>
      )}
      <details>
        <summary>{report.channels.length} channels</summary>
        <div class="table-scroll">
          <table>
            <thead>
              <tr>
                <th scope="col">Channel</th>
                <th scope="col">From</th>
                <th scope="col">Least</th>
                <th scope="col">Greatest</th>
                <th scope="col">Gaps</th>
              </tr>
            </thead>
            <tbody>
              {report.channels.map(({ channel, from, unit, least, greatest, gaps }) => (
                <tr key={channel}>
                  <th scope="row">{channelOf(channel)?.label ?? words(channel)}</th>
                  <td>
                    {from} [{unit}]
                  </td>
                  <td>{`${plain(least)} ${unitOf(channel)}`}</td>
                  <td>{`${plain(greatest)} ${unitOf(channel)}`}</td>
                  <td>{gaps}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      </details>
    </>
  );
}

/** The unit that a channel is kept in. */
const unitOf = (name: string) => channelOf(name)?.units[0] ?? "";

export function Fact({ name, value }: { name: string; value: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}
