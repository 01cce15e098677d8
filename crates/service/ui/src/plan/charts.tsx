/** Elevation, pitch, power and energy against distance, one under the other, linked with the map. */
import { useMemo } from "preact/hooks";
import type { Pose } from "../api/plans";
import { degrees, energy, metres, power } from "../format";
import { poseAt } from "../map/along";
import { STYLE } from "../map/draw";
import { Chart, type Line } from "../widgets/chart";
import { focusedPath, followedPaths, type ShownPath } from "./shown_paths";
import * as state from "./state";

interface Quantity {
  name: string;
  unit: string;
  of: (pose: Pose) => number;
  written: (value: number) => string;
  /** From SI to what the axis shows. */
  factor: number;
}

const QUANTITIES: Quantity[] = [
  { name: "Elevation", unit: "m", of: (p) => p.z_m, written: metres, factor: 1 },
  { name: "Pitch", unit: "°", of: (p) => p.pitch_rad, written: degrees, factor: 180 / Math.PI },
  { name: "Power", unit: "W", of: (p) => p.power_w, written: power, factor: 1 },
  { name: "Energy", unit: "kJ", of: (p) => p.energy_j, written: energy, factor: 1e-3 },
];

export function Charts() {
  return (
    <section class="charts" aria-label="Along the path">
      {QUANTITIES.map((quantity) => (
        <One key={quantity.name} quantity={quantity} />
      ))}
    </section>
  );
}

/** Points of a chart: more than its pixels are not seen. */
const POINTS = 240;

/** All paths on one axis of distance, the focused one last and so on top. */
function columns(paths: ShownPath[], { of, factor }: Quantity): (number | null)[][] {
  const longest_m = Math.max(...paths.map(({ distance_m }) => distance_m));
  const distances = Array.from({ length: POINTS + 1 }, (_, i) => (longest_m * i) / POINTS);
  const values = paths.map(({ poses, distance_m }) => {
    return distances.map((d) => {
      const pose = d <= distance_m + longest_m / POINTS / 2 ? poseAt(poses, d) : null;
      return pose && factor * of(pose);
    });
  });
  return [distances, ...values];
}

function One({ quantity }: { quantity: Quantity }) {
  const [paths, focused] = [followedPaths.value, focusedPath.value];
  const data = useMemo(() => (paths.length > 0 ? columns(paths, quantity) : null), [paths]);
  const lines: Line[] = paths.map((path) => {
    const { color, dash, name } = STYLE[path.style];
    const isFocus = path === focused;
    return { name, color, width: isFocus ? 2 : 1.25, fill: false, ...(!isFocus && dash.length > 0 && { dash: dash.map((d) => d / 1.6) }) };
  });
  const pose = focused && state.along_m.value !== null ? poseAt(focused.poses, state.along_m.value) : null;
  return (
    <figure class="chart-card">
      <figcaption>
        <span>
          {quantity.name} <small>{quantity.unit}</small>
        </span>
        <b class="number">{pose ? quantity.written(quantity.of(pose)) : ""}</b>
      </figcaption>
      {data ? (
        <Chart
          label={`${quantity.name} along the paths, ${quantity.unit} against metres`}
          height={118}
          data={data}
          lines={lines}
          axisUnit="m"
          at={state.along_m.value}
          point={(at_m) => (state.along_m.value = focused ? Math.min(Math.max(at_m, 0), focused.distance_m) : null)}
        />
      ) : (
        <div class="chart-none" aria-hidden="true" />
      )}
    </figure>
  );
}
