/** What the contours of energy mean. */
import { energy } from "../format";
import * as state from "../plan/state";
import { color, theme } from "../theme";
import { between } from "./reach_ramp";

const TITLES = { outward: "Reached from the start", homeward: "Start reached from there", "out-and-back": "There and back" };

export function ReachLegend() {
  const [contours, kind] = [state.contours.value, state.reach.value];
  void theme.value;
  const [first, last] = [contours[0], contours.at(-1)];
  if (!first || !last || !kind) return null;
  const label = `${contours.length} contours from ${energy(first.energy_j)} to ${energy(last.energy_j)}`;
  return (
    <figure class="legend reach-legend">
      <figcaption>{TITLES[kind]} with</figcaption>
      <div class="reach-steps" role="img" aria-label={label}>
        {contours.map(({ energy_j }, i) => (
          <i key={energy_j} style={{ backgroundColor: between(color, i, contours.length) }} title={energy(energy_j)} />
        ))}
      </div>
      <div class="legend-ends">
        <span>{energy(first.energy_j)}</span>
        {contours.length > 1 && <span>{energy(last.energy_j)}</span>}
      </div>
    </figure>
  );
}
