/** The Diagnose tab: recordings in, progress, report. */
import { Problem } from "../api/problem";
import { ProblemCard } from "../widgets/problem_card";
import { RobotSelect } from "../widgets/robot_select";
import { UnderWay } from "../widgets/under_way";
import { Recordings } from "./recordings";
import { ReportPage } from "./report_page";
import { again, begin, cancel, idsOf, job, problem, robotId, taken } from "./state";
import * as plan from "../plan/state";

export function DiagnoseTab() {
  const now = job.value;
  return (
    <div class="diagnose">
      {problem.value && <ProblemCard problem={problem.value} close={() => (problem.value = null)} />}
      {!now && <Ask />}
      {now && (now.state === "queued" || now.state === "running") && (
        <UnderWay
          title="Diagnosing"
          about="Every known mechanism is fitted to the drives beside the refitted robot and judged where it was not fitted."
          job={now}
          cancel={cancel}
        />
      )}
      {now?.state === "done" && now.result && <ReportPage report={now.result} />}
      {now?.state === "failed" && now.problem && <ProblemCard problem={new Problem(now.problem)} retry={again} />}
      {now?.state === "cancelled" && (
        <div class="notice">
          <p>The diagnosis was called off.</p>
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
        <h2>When a drive took more than was predicted</h2>
        <p>
          Give its recording. joulepath finds where model and recording differ, which physics was left out, how big it is, and how sure that
          is.
        </p>
      </header>
      <Recordings roles={["suspect", "healthy"]} />
      <footer class="diagnose-start">
        <RobotSelect label="Robot that drove" value={robotId.value ?? plan.robotId.value} choose={(id) => (robotId.value = id)} />
        <button type="button" class="primary" disabled={!isReady} onClick={() => void begin()}>
          Diagnose
        </button>
        {!isReady && (
          <small>
            {taken.value.length === 0 ? "A recording of the suspect drive is needed." : "Waiting for a recording that can be read."}
          </small>
        )}
      </footer>
      {taken.value.length === 0 && (
        <p class="diagnose-none">
          No recording at hand? <code>joulepath simulate</code> drives a robot through a world of its own, which may conceal what there is
          to find.
        </p>
      )}
    </>
  );
}
