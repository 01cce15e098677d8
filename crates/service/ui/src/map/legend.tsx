/** What the ground's colours mean. */
import { degrees, metres, words } from "../format";
import * as state from "../plan/state";
import type { Cells } from "../api/maps";
import { ELEVATION, gradient, OBSTACLE, SLOPE, UNKNOWN, type Rgb } from "./ramp";
import { surfaceColor } from "./relief";

export function Legend({ least, greatest }: { least: number; greatest: number }) {
  const layer = state.layer.value;
  if (layer === "surface") return <Surfaces />;
  const isSlope = layer === "slope";
  const written = isSlope ? (value: number) => degrees(value, 0) : metres;
  return (
    <figure class="legend">
      <figcaption>{isSlope ? "Slope" : "Elevation"}</figcaption>
      <div class="legend-ramp" style={{ backgroundImage: gradient(isSlope ? SLOPE : ELEVATION) }} />
      <div class="legend-ends">
        <span>{written(least)}</span>
        <span>
          {isSlope && "≥ "}
          {written(greatest)}
        </span>
      </div>
      {state.cells.value && <Swatches of={blockedOf(state.cells.value)} />}
    </figure>
  );
}

function Surfaces() {
  const cells = state.cells.value;
  return (
    <figure class="legend">
      <figcaption>Surface</figcaption>
      {cells && <Swatches of={surfacesOf(cells)} />}
    </figure>
  );
}

interface Kind {
  name: string;
  rgb: Rgb;
}

/** Where nothing can drive. */
function blockedOf({ obstacle, z_m }: Cells): Kind[] {
  return [
    ...(obstacle.includes(1) ? [{ name: "obstacle", rgb: OBSTACLE }] : []),
    ...(z_m.some((z) => Number.isNaN(z)) ? [{ name: "unknown", rgb: UNKNOWN }] : []),
  ];
}

function surfacesOf(cells: Cells): Kind[] {
  const open = cells.surface.includes(255) ? [{ name: "left open", rgb: surfaceColor(255) }] : [];
  return [...cells.surfaces.map((name, i) => ({ name: words(name), rgb: surfaceColor(i) })), ...open, ...blockedOf(cells)];
}

function Swatches({ of }: { of: Kind[] }) {
  return (
    <ul class="legend-list">
      {of.map(({ name, rgb }) => (
        <li key={name}>
          <i style={{ backgroundColor: `rgb(${rgb.join(" ")})` }} />
          {name}
        </li>
      ))}
    </ul>
  );
}
