/** The Calibrate tab: drives in, progress, the fitted robot. */
import type { Problem } from "../api/problem";
import { Ask, JobTab } from "../diagnose/job_tab";
import { GuideLink } from "../widgets/guide_link";
import { CalibrationPage } from "./calibration_page";
import { doubtsOf } from "./doubts";
import { again, begin, cancel, job, problem } from "./state";

export function CalibrateTab() {
  return (
    <JobTab
      job={job.value}
      problem={problem}
      title="Calibrating"
      about="The robot's parameters are fitted to the drives, and each half of the drives is predicted by the fit of the other."
      name="The calibration"
      cancel={cancel}
      again={again}
      ask={<Question />}
      found={(result) => <CalibrationPage found={result} />}
      refused={(refusal) => <Overrule refusal={refusal} />}
    />
  );
}

function Question() {
  return (
    <Ask
      title="Fit a robot to its drives"
      about={
        <>
          Give recordings of usual drives, with turns and stops. joulepath fits friction, motors and standing loads to them, says what they
          determine, and how well the fitted robot predicts drives that it was not fitted to.{" "}
          <GuideLink chapter="logs">What to record</GuideLink>
        </>
      }
      roles={["suspect"]}
      needed="A recording is needed."
      act="Calibrate"
      begin={() => begin()}
    />
  );
}

/** Where doubts about the recordings are the reason of a refusal, they may be mended or overruled. */
function Overrule({ refusal }: { refusal: Problem }) {
  const doubts = doubtsOf(refusal.document.detail);
  if (doubts.length === 0) return null;
  return (
    <div class="notice">
      <p>Units, signs and meanings of columns are mended beside each recording, under “Say what its columns are”.</p>
      <p>If the recordings are right as they are, overrule the doubts: {doubts.join(", ")}.</p>
      <button type="button" onClick={() => void begin(doubts)}>
        Calibrate despite them
      </button>
    </div>
  );
}
