/** The Diagnose tab: recordings in, progress, report. */
import { GuideLink } from "../widgets/guide_link";
import { Ask, JobTab } from "./job_tab";
import { ReportPage } from "./report_page";
import { again, begin, cancel, job, problem, taken } from "./state";

export function DiagnoseTab() {
  return (
    <JobTab
      job={job.value}
      problem={problem}
      title="Diagnosing"
      about="Every known mechanism is fitted to the drives beside the refitted robot and judged where it was not fitted."
      name="The diagnosis"
      cancel={cancel}
      again={again}
      ask={<Question />}
      found={(report) => <ReportPage report={report} />}
    />
  );
}

function Question() {
  return (
    <>
      <Ask
        title="When a drive took more than was predicted"
        about={
          <>
            Give its recording. joulepath finds where model and recording differ, which physics was left out, how big it is, and how sure
            that is. <GuideLink chapter="diagnose">How to read it</GuideLink>
          </>
        }
        roles={["suspect", "healthy"]}
        needed="A recording of the suspect drive is needed."
        act="Diagnose"
        begin={begin}
      />
      {taken.value.length === 0 && (
        <p class="diagnose-none">
          No recording at hand? <code>joulepath simulate</code> drives a robot through a world of its own, which may conceal what there is
          to find.
        </p>
      )}
    </>
  );
}
