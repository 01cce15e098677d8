/** The error of the robot's file as it is, and recorded power against its prediction. */
import { percent, power } from "../format";
import type { Report } from "./report";
import { PowerOverTime, type Shown } from "./time_axis";

export function FileError({ report, shown }: { report: Report; shown: Shown | null }) {
  const { file, baseline } = report;
  const { bias_w, rmse_w } = file ?? baseline;
  const way = bias_w >= 0 ? "too low" : "too high";
  const size_w = power(Math.abs(bias_w));
  const share =
    file && file.mean_power_w > 0
      ? `, ${percent(Math.abs(bias_w) / file.mean_power_w, 1)} of the mean power of ${power(file.mean_power_w)}`
      : "";
  return (
    <section class="card file-error" aria-label="Error of the robot file">
      <h3>Error of the robot file</h3>
      <p>
        The robot file predicts these drives{" "}
        <b>
          {size_w} {way}
        </b>{" "}
        on average{share} ({power(rmse_w)} RMSE; noise {power(file?.noise_w ?? baseline.noise_floor_w)}).
      </p>
      {file?.findings && file.findings.length > 0 && (
        <>
          <p>The healthy drives need this beside the robot file as well, so that it is a property of this robot and sets no verdict:</p>
          <ul>
            {file.findings.map((finding) => (
              <li key={finding.mechanism}>{finding.statement}.</li>
            ))}
          </ul>
        </>
      )}
      {shown && <PowerOverTime {...shown} />}
    </section>
  );
}
