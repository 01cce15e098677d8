/** Power and its errors over time; where recording and file differ is shaded. */
import { useMemo } from "preact/hooks";
import { Chart, type Band } from "../widgets/chart";
import { Choice } from "../widgets/choice";
import { pointed } from "./pointed";
import type { Difference, Trace } from "./report";

/** The points of one drive. */
export function indicesOf(trace: Trace, run: number): number[] {
  return trace.run.flatMap((of, i) => (of === run ? [i] : []));
}

/** Seconds driven before a drive, drives behind one another. */
function drivenBefore(trace: Trace, run: number): number {
  const ends = trace.runs.map(() => 0);
  trace.run.forEach((of, i) => (ends[of] = Math.max(ends[of] ?? 0, (trace.t_s[i] ?? 0) + 0.5)));
  return ends.slice(0, run).reduce((sum, end) => sum + end, 0);
}

/** Parts of one drive's time that the report names. */
export function bandsOf(where: Difference[], trace: Trace, run: number): Band[] {
  const times = where.filter(({ kind }) => kind === "time");
  const ofRun = times.filter(({ range }) => range.name === null || range.name === trace.runs[run]);
  return ofRun.map(({ range }) => {
    const before = range.quantity === "driven_s" ? drivenBefore(trace, run) : 0;
    return { from: (range.from ?? -Infinity) - before, to: (range.to ?? Infinity) - before };
  });
}

/** The drive that both charts show, and what they shade. */
export interface Shown {
  trace: Trace;
  where: Difference[];
  run: number;
  showRun: (run: number) => void;
}

/** Recorded power and the prediction of the robot's file. */
export function PowerOverTime(shown: Shown) {
  const { trace, run, showRun } = shown;
  const data = useMemo(() => {
    const indices = indicesOf(trace, run);
    const pick = (values: (number | null)[]) => indices.map((i) => values[i] ?? null);
    return [pick(trace.t_s), pick(trace.recorded_w), pick(trace.filed_w)];
  }, [trace, run]);
  return (
    <figure>
      <header>
        <h4>
          Power <small>W</small>
        </h4>
        {trace.runs.length > 1 && (
          <Choice
            label="Drive"
            value={String(run)}
            choose={(value) => showRun(Number(value))}
            options={trace.runs.map((name, i) => ({ value: String(i), name }))}
          />
        )}
      </header>
      <p class="key">
        <Key color="recorded">recorded</Key>
        <Key color="before">predicted by the robot's file</Key>
        <Shade shown={shown} />
      </p>
      <Chart
        label="Power over time, recorded and predicted by the robot's file"
        height={170}
        data={data}
        lines={[
          { name: "recorded", color: "recorded", width: 3 },
          { name: "robot's file", color: "before", width: 1 },
        ]}
        bands={bandsOf(shown.where, trace, run)}
        axisUnit="s"
        {...linkOf(run)}
      />
    </figure>
  );
}

/** What the robot's file and the corrected model leave of the recorded power. */
export function ErrorsOverTime(shown: Shown) {
  const { trace, run } = shown;
  const data = useMemo(() => {
    const indices = indicesOf(trace, run);
    const errors = (predicted: (number | null)[]) =>
      indices.map((i) => (trace.recorded_w[i] == null || predicted[i] == null ? null : trace.recorded_w[i] - predicted[i]));
    return [indices.map((i) => trace.t_s[i] ?? null), errors(trace.filed_w), errors(trace.corrected_w)];
  }, [trace, run]);
  return (
    <figure>
      <h4>
        Recorded less predicted power <small>W</small>
      </h4>
      <p class="key">
        <Key color="before">robot's file</Key>
        <Key color="after">corrected model</Key>
        <Shade shown={shown} />
      </p>
      <Chart
        label="Recorded less predicted power over time, by the robot's file and by the corrected model"
        height={170}
        data={data}
        lines={[
          { name: "robot's file", color: "before", width: 1 },
          { name: "corrected", color: "after", width: 1.25 },
        ]}
        bands={bandsOf(shown.where, trace, run)}
        axisUnit="s"
        {...linkOf(run)}
      />
    </figure>
  );
}

/** Ties a chart to the moment that the others and the map point at. */
function linkOf(run: number) {
  const at = pointed.value?.run === run ? pointed.value.t_s : null;
  return { at, point: (t_s: number) => (pointed.value = { run, t_s }) };
}

function Shade({ shown: { where, trace, run } }: { shown: Shown }) {
  if (bandsOf(where, trace, run).length === 0) return null;
  return (
    <span class="key-band">
      <i /> where they differ
    </span>
  );
}

function Key({ color, children }: { color: string; children: string }) {
  return (
    <span>
      <i style={{ backgroundColor: `var(--${color})` }} />
      {children}
    </span>
  );
}
