/** Errors before and after, down to the noise that no model predicts. */
import { power } from "../format";
import type { Report } from "./report";

export function Bars({ report: { baseline, corrected } }: { report: Report }) {
  const bars = [
    { name: "Robot's file", value_w: baseline.rmse_w, kind: "before" },
    { name: "Refitted, held out", value_w: baseline.held_out_rmse_w, kind: "before" },
    { name: "Corrected, held out", value_w: corrected.held_out_rmse_w, kind: "after" },
  ];
  const most_w = Math.max(...bars.map(({ value_w }) => value_w), baseline.noise_floor_w) * 1.02;
  const share = (value_w: number) => `${(100 * value_w) / most_w}%`;
  return (
    <div class="bars">
      {bars.map(({ name, value_w, kind }) => (
        <div class="bar" key={name} data-kind={kind}>
          <span>{name}</span>
          <div class="bar-track">
            <i style={{ width: share(value_w) }} />
            <em style={{ left: share(baseline.noise_floor_w) }} />
          </div>
          <b class="number">{power(value_w)}</b>
        </div>
      ))}
      <p class="bars-note">
        Root mean square error over averages of one second. The line is the noise floor,{" "}
        <b class="number">{power(baseline.noise_floor_w)}</b>: what no model could predict.
      </p>
    </div>
  );
}
