/** What the ground's colours mean. */
import { degrees, metres, words } from "../format";
import * as state from "../plan/state";
import { ELEVATION, gradient, SLOPE, UNKNOWN } from "./ramp";
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
    </figure>
  );
}

function Surfaces() {
  const names = state.map.value?.surfaces ?? [];
  const swatch = (rgb: number[]) => ({ backgroundColor: `rgb(${rgb.join(" ")})` });
  return (
    <figure class="legend">
      <figcaption>Surface</figcaption>
      <ul class="legend-list">
        {names.map((name, i) => (
          <li key={name}>
            <i style={swatch(surfaceColor(i))} />
            {words(name)}
          </li>
        ))}
        <li>
          <i style={swatch(surfaceColor(255))} />
          not named
        </li>
        {(state.map.value?.passable_fraction ?? 1) < 1 && (
          <li>
            <i style={swatch(UNKNOWN)} />
            unknown
          </li>
        )}
      </ul>
    </figure>
  );
}
