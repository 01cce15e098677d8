/** The Calibrate tab: drives in, progress, the fitted robot. */
import { Problem } from "../api/problem";
import { Recordings } from "../diagnose/recordings";
import { idsOf, robotId, taken } from "../diagnose/state";
import * as plan from "../plan/state";
import { ProblemCard } from "../widgets/problem_card";
import { RobotSelect } from "../widgets/robot_select";
import { UnderWay } from "../widgets/under_way";
import { CalibrationPage } from "./calibration_page";
import { doubtsOf } from "./doubts";
import { again, begin, cancel, job, problem } from "./state";

export function CalibrateTab() {
  const now = job.value;
  return (
    <div class="diagnose">
      {problem.value && <ProblemCard problem={problem.value} close={() => (problem.value = null)} />}
      {!now && <Ask />}
      {now && (now.state === "queued" || now.state === "running") && (
        <UnderWay
          title="Calibrating"
          about="The robot's parameters are fitted to the drives, and each half of the drives is predicted by the fit of the other."
          job={now}
          cancel={cancel}
        />
      )}
      {now?.state === "done" && now.result && <CalibrationPage found={now.result} />}
      {now?.state === "failed" && now.problem && <Refused problem={new Problem(now.problem)} />}
      {now?.state === "cancelled" && (
        <div class="notice">
          <p>The calibration was called off.</p>
          <button type="button" class="primary" onClick={again}>
            Back to the recordings
          </button>
        </div>
      )}
    </div>
  );
}

function Ask() {
  const isReady = idsOf("suspect").length > 0 && taken.value.every((one) => one.recording || one.problem);
  return (
    <>
      <header class="diagnose-head">
        <h2>Fit a robot to its drives</h2>
        <p>
          Give recordings of usual drives, with turns and stops. joulepath fits friction, motors and standing loads to them, says what they
          determine, and how well the fitted robot predicts drives that it was not fitted to.
        </p>
      </header>
      <Recordings roles={["suspect"]} />
      <footer class="diagnose-start">
        <RobotSelect label="Robot that drove" value={robotId.value ?? plan.robotId.value} choose={(id) => (robotId.value = id)} />
        <button type="button" class="primary" disabled={!isReady} onClick={() => void begin()}>
          Calibrate
        </button>
        {!isReady && (
          <small>{taken.value.length === 0 ? "A recording is needed." : "Waiting for a recording that can be read and is ticked."}</small>
        )}
      </footer>
    </>
  );
}

/** A refusal; where doubts about the recordings are its reason, they may be overruled. */
function Refused({ problem: refusal }: { problem: Problem }) {
  const doubts = doubtsOf(refusal.document.detail);
  return (
    <>
      <ProblemCard problem={refusal} retry={again} />
      {doubts.length > 0 && (
        <div class="notice">
          <p>If the recordings are right as they are, overrule the doubts: {doubts.join(", ")}.</p>
          <button type="button" onClick={() => void begin(doubts)}>
            Calibrate despite them
          </button>
        </div>
      )}
    </>
  );
}
