/** Recorded and predicted power over time; where they differ is shaded. */
import { useMemo, useState } from "preact/hooks";
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

export function TimeAxis({ trace, where }: { trace: Trace; where: Difference[] }) {
  const [run, setRun] = useState(trace.run[0] ?? 0);
  const data = useMemo(() => {
    const indices = indicesOf(trace, run);
    const pick = (values: (number | null)[]) => indices.map((i) => values[i] ?? null);
    const errors = (predicted: (number | null)[]) =>
      indices.map((i) => (trace.recorded_w[i] == null || predicted[i] == null ? null : trace.recorded_w[i] - predicted[i]));
    const axis = pick(trace.t_s);
    return {
      power: [axis, pick(trace.recorded_w), pick(trace.corrected_w)],
      error: [axis, errors(trace.filed_w), errors(trace.corrected_w)],
    };
  }, [trace, run]);
  const bands = bandsOf(where, trace, run);
  const link = { at: pointed.value?.run === run ? pointed.value.t_s : null, point: (t_s: number) => (pointed.value = { run, t_s }) };
  return (
    <section class="card time-axis" aria-label="Power over time">
      <header>
        <h3>Over time</h3>
        {trace.runs.length > 1 && (
          <Choice
            label="Drive"
            value={String(run)}
            choose={(value) => setRun(Number(value))}
            options={trace.runs.map((name, i) => ({ value: String(i), name }))}
          />
        )}
      </header>
      <p class="key">
        <Key color="recorded">recorded</Key>
        <Key color="after">corrected model</Key>
        <Key color="before">robot's file</Key>
        {bands.length > 0 && (
          <span class="key-band">
            <i /> where they differ
          </span>
        )}
      </p>
      <h4>
        Power <small>W</small>
      </h4>
      <Chart
        label="Power over time, recorded and by the corrected model"
        height={150}
        data={data.power}
        lines={[
          { name: "recorded", color: "recorded", width: 3 },
          { name: "corrected", color: "after", width: 1 },
        ]}
        bands={bands}
        hasAxis={false}
        {...link}
      />
      <h4>
        Recorded less predicted <small>W</small>
      </h4>
      <Chart
        label="Recorded less predicted power over time, by the robot's file and by the corrected model"
        height={170}
        data={data.error}
        lines={[
          { name: "robot's file", color: "before", width: 1 },
          { name: "corrected", color: "after", width: 1.25 },
        ]}
        bands={bands}
        axisUnit="s"
        {...link}
      />
    </section>
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
