/** What each column of a log is and in which unit, with a plot of the one that is looked at. */
import { useState } from "preact/hooks";
import { readNumber } from "../number";
import * as plan from "../plan/state";
import { Chart } from "../widgets/chart";
import { channelOf } from "./channels";
import { guessAll, offered, unitFor, type Pick } from "./guess";
import { mapOf, missing, needsRadius, picksOf, type RecordingMap } from "./recording_map";
import { isDate, isOfTopics, numberOf, titleOf, type Column } from "./table";

interface Props {
  columns: Column[];
  /** Whether the service did not know them by their names. */
  isUnknown: boolean;
  /** What was said of them before. */
  before: RecordingMap | undefined;
  /** Number of other recordings with the same columns, which are read alike. */
  others: number;
  /** The robot whose wheels turned. */
  robotId: string;
  take: (map: RecordingMap) => void;
}

export function ColumnPicker({ columns, isUnknown, before, others, robotId, take }: Props) {
  const robot = plan.robots.value?.find(({ id }) => id === robotId)?.robot;
  const [picks, setPicks] = useState(() => (before ? picksOf(columns, before) : guessAll(columns)));
  const [radius, setRadius] = useState(String(before?.wheel_radius_m ?? robot?.wheel_radius_m ?? ""));
  const [looked, look] = useState(() =>
    Math.max(
      0,
      picks.findIndex(({ channel }) => channel !== null && channel !== "t_s"),
    ),
  );
  const given_m = readNumber(radius);
  const radius_m = given_m !== null && given_m > 0 ? given_m : null;
  const time = picks.findIndex(({ channel }) => channel === "t_s");
  const isDated = columns[time]?.cells.some(isDate) ?? false;
  const fault = missing(columns, picks, radius_m);
  const set = (at: number, change: Partial<Pick>) => {
    setPicks(picks.map((pick, i) => (i === at ? { ...pick, ...change } : pick)));
    look(at);
  };
  return (
    <section class="columns" aria-label="Columns of the log">
      {isUnknown && <p role="alert">The names in this file do not say what its numbers are.</p>}
      <p>
        Say what each column is, and in which unit.
        {!before && picks.some(({ channel }) => channel !== null) && " What is filled in already is a guess by its name and numbers."}
      </p>
      <div class="table-scroll" tabIndex={0} role="region" aria-label="Columns">
        <table>
          <thead>
            <tr>
              <th scope="col">{isOfTopics(columns) ? "Topic and field" : "Column"}</th>
              <th scope="col">Begins with</th>
              <th scope="col">Is</th>
              <th scope="col">In</th>
              <th scope="col">Sign</th>
            </tr>
          </thead>
          <tbody>
            {columns.map((column, i) => (
              <Row
                key={titleOf(column)}
                column={column}
                pick={picks[i]!}
                isLooked={i === looked}
                look={() => look(i)}
                set={(c) => set(i, c)}
              />
            ))}
          </tbody>
        </table>
      </div>
      {columns[looked] && <Preview column={columns[looked]} />}
      {needsRadius(picks) && (
        <label class="field columns-radius">
          <span>Wheel radius</span>
          <span class="number-box">
            <input
              type="text"
              inputMode="decimal"
              value={radius}
              aria-describedby="columns-radius-about"
              onInput={(event) => setRadius(event.currentTarget.value)}
            />
            <span>m</span>
          </span>
          <small id="columns-radius-about">above 0, up to 2 m</small>
        </label>
      )}
      <p class="columns-acts">
        <button type="button" class="primary" disabled={fault !== null} onClick={() => take(mapOf(columns, picks, radius_m, isDated))}>
          Read with these columns
        </button>
        {fault && <small role="status">{fault}</small>}
        {!fault && others > 0 && (
          <small>
            {others === 1
              ? "The other recording with these columns is read alike."
              : `The ${others} other recordings with these columns are read alike.`}
          </small>
        )}
      </p>
    </section>
  );
}

interface RowProps {
  column: Column;
  pick: Pick;
  isLooked: boolean;
  look: () => void;
  set: (change: Partial<Pick>) => void;
}

function Row({ column, pick, isLooked, look, set }: RowProps) {
  const { cells } = column;
  const name = titleOf(column);
  const units = (pick.channel && channelOf(pick.channel)?.units) || [];
  const choose = (named: string) => {
    const channel = channelOf(named);
    set({ channel: channel?.name ?? null, unit: channel ? unitFor(column, channel) : "" });
  };
  return (
    <tr data-chosen={isLooked} onClick={look}>
      <th scope="row">{name}</th>
      <td class="columns-cells">{cells.slice(0, 2).join(" · ")}</td>
      <td>
        <select aria-label={`${name} is`} value={pick.channel ?? ""} onFocus={look} onChange={(event) => choose(event.currentTarget.value)}>
          <option value="">left out</option>
          {offered([column]).map((channel) => (
            <option key={channel.name} value={channel.name}>
              {channel.label}
            </option>
          ))}
        </select>
      </td>
      <td>
        {pick.channel === "t_s" && cells.some(isDate)
          ? "dates"
          : units.length > 0 && (
              <select aria-label={`Unit of ${name}`} value={pick.unit} onChange={(event) => set({ unit: event.currentTarget.value })}>
                {units.map((unit) => (
                  <option key={unit} value={unit}>
                    {unit}
                  </option>
                ))}
              </select>
            )}
      </td>
      <td>
        {pick.channel && pick.channel !== "t_s" && units.length > 0 && (
          <button
            type="button"
            aria-label={`Turn the sign of ${name}`}
            aria-pressed={pick.isTurned}
            onClick={() => set({ isTurned: !pick.isTurned })}
          >
            {pick.isTurned ? "−" : "+"}
          </button>
        )}
      </td>
    </tr>
  );
}

/** Points of the plot: more are not seen. */
const POINTS = 600;

function Preview({ column }: { column: Column }) {
  const [name, { cells }] = [titleOf(column), column];
  const step = Math.ceil(cells.length / POINTS);
  const shown = cells.filter((_, i) => i % step === 0).map(numberOf);
  if (!shown.some((value) => Number.isFinite(value))) return <p class="bars-note">{name} holds no numbers to plot.</p>;
  const values = shown.map((value) => (Number.isFinite(value) ? value : null));
  return (
    <figure class="columns-plot">
      <figcaption>
        {name}, as it stands in the file, over the first {cells.length.toLocaleString("en")} rows
      </figcaption>
      <Chart
        label={`${name} by row`}
        height={110}
        data={[shown.map((_, i) => i * step), values]}
        lines={[{ name, color: "path-energy" }]}
        axisUnit="rows"
      />
    </figure>
  );
}
