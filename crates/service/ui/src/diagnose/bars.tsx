/** Errors before and after, down to the noise that no model predicts. */
import { power } from "../format";
import type { Report } from "./report";

export function Bars({ report: { file, baseline, corrected, findings } }: { report: Report }) {
  const hasFindings = findings.length > 0;
  const bars = [
    { name: "Robot's file", value_w: baseline.rmse_w, kind: "before" },
    { name: "Refitted, held out", value_w: baseline.held_out_rmse_w, kind: "before" },
    ...(hasFindings ? [{ name: "With the findings, held out", value_w: corrected.held_out_rmse_w, kind: "after" }] : []),
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
        Root mean square error over one-second averages of each power channel. The line is the noise floor,{" "}
        <b class="number">{power(baseline.noise_floor_w)}</b>: what no model predicts.
        {file && Math.abs(file.rmse_w - baseline.rmse_w) > 0.05 && (
          <> Each channel counts by itself here; of the whole power the robot file is off by {power(file.rmse_w)}.</>
        )}
      </p>
    </div>
  );
}
