/** A fitted robot: how well it predicts, what the drives determine, and what was left out of them. */
import { duration, percent, plain, power, quantity, sentence } from "../format";
import { Fact } from "../diagnose/recordings";
import { saveFile } from "../plan/downloads";
import { Marked } from "../widgets/marked";
import { read } from "../robots/pointer";
import { drove } from "../diagnose/state";
import type { Calibration, Parameter } from "./report";
import { accept, again } from "./state";

export function CalibrationPage({ found }: { found: Calibration }) {
  const { parameters, notes, coverage, held_out: heldOut } = found;
  const known = parameters.filter(({ determined }) => determined);
  const held = parameters.filter(({ determined }) => !determined);
  const before = drove.value.robot;
  const others = notes.flatMap((note) => (isComparison(note) ? note.split("; ").slice(1) : [note]));
  return (
    <article class="report calibration">
      <header class="verdict" data-verdict="explained">
        <p class="verdict-name">Calibrated</p>
        <h2>{headline(found)}</h2>
        <div class="verdict-acts">
          <button type="button" class="primary" onClick={() => void accept(found)}>
            Save the fitted robot and plan with it
          </button>
          <button
            type="button"
            onClick={() => saveFile(new Blob([JSON.stringify(found, null, 2)], { type: "application/json" }), "calibration.json")}
          >
            Download the report
          </button>
          <button type="button" onClick={again}>
            Another calibration
          </button>
        </div>
      </header>
      {others.length > 0 && (
        <section class="card" aria-label="Notes">
          <h3>Read this first</h3>
          <ul>
            {others.map((note) => (
              <li key={note}>
                <Marked text={sentence(note)} />
              </li>
            ))}
          </ul>
        </section>
      )}
      <section class="card" aria-label="Skill">
        <h3>Prediction of drives that it was not fitted to</h3>
        <dl class="facts">
          {heldOut?.second_r2 !== undefined && <Fact name="R², one-second averages" value={heldOut.second_r2.toFixed(3)} />}
          {heldOut?.second_rmse_w !== undefined && <Fact name="RMSE, one-second averages" value={power(heldOut.second_rmse_w)} />}
          {heldOut?.r2_a !== undefined && <Fact name="R² of the side currents" value={heldOut.r2_a.toFixed(3)} />}
          {heldOut?.median_energy_error_percent !== undefined && (
            <Fact name="Energy of a drive, median error" value={percent(heldOut.median_energy_error_percent / 100, 1)} />
          )}
          {coverage && <Fact name="Used" value={`${duration(coverage.total.used_s)} of ${duration(coverage.total.recorded_s)}`} />}
        </dl>
        {!heldOut && <p>One drive alone leaves none to judge by: record another one.</p>}
        {coverage && coverage.total.left_out.length > 0 && (
          <ul class="warnings">
            {coverage.total.left_out.map(({ duration_s, reason }) => (
              <li key={reason}>
                {plain(duration_s)} s left out: <Marked text={reason} />
              </li>
            ))}
          </ul>
        )}
      </section>
      <section class="card" aria-label="Parameters">
        <h3>What the drives determine</h3>
        <div class="table-scroll" tabIndex={0} role="region" aria-label="Fitted parameters">
          <table>
            <thead>
              <tr>
                <th scope="col">Parameter</th>
                <th scope="col">Before</th>
                <th scope="col">Fitted</th>
                <th scope="col">95 % interval</th>
              </tr>
            </thead>
            <tbody>
              {known.map((parameter) => (
                <Row key={parameter.name} of={parameter} before={read(before, `/${parameter.name.replaceAll(".", "/")}`)} />
              ))}
            </tbody>
          </table>
        </div>
        {held.length > 0 && <p>Held at what was known before: {held.map(({ name, unit }) => label(name, unit)).join(", ")}.</p>}
      </section>
    </article>
  );
}

/** Whether a note compares the file before with the file as it is now; what follows in it is about noise. */
const isComparison = (note: string) => note.startsWith("the robot file as it was");

function headline({ notes, held_out: heldOut }: Calibration): string {
  const [compared = ""] = notes.find(isComparison)?.split(";") ?? [];
  if (compared) return sentence(compared);
  return heldOut?.second_r2 === undefined
    ? "The robot is fitted to the drives."
    : `The fitted robot explains ${percent(heldOut.second_r2, 1)} of the variance of power in drives that it was not fitted to.`;
}

/** `surfaces.marble.mu_roll` as words. */
const label = (name: string, unit: string) =>
  name
    .split(".")
    .filter((part) => part !== "surfaces" && part !== "motors")
    .map((part, i, all) => (i === all.length - 1 ? quantity(part, unit) : part.replaceAll("_", " ")))
    .join(", ");

function Row({ of: { name, value, unit, interval_95 }, before }: { of: Parameter; before: unknown }) {
  const shownUnit = unit === "1" ? "" : ` ${unit}`;
  return (
    <tr>
      <th scope="row">{label(name, unit)}</th>
      <td>{typeof before === "number" ? plain(before) : "–"}</td>
      <td>
        <b>{plain(value)}</b>
        {shownUnit}
      </td>
      <td>{interval_95 ? `${plain(interval_95[0])} to ${plain(interval_95[1])}` : "–"}</td>
    </tr>
  );
}
