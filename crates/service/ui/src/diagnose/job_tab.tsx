/** A tab whose work is a job over recordings: what is asked, its progress, and how it ended. */
import type { Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import type { KnownJob } from "../api/jobs";
import { Problem } from "../api/problem";
import * as plan from "../plan/state";
import { words } from "../format";
import { ProblemCard } from "../widgets/problem_card";
import { RobotSelect } from "../widgets/robot_select";
import { UnderWay } from "../widgets/under_way";
import { Recordings } from "./recordings";
import { drove, ground, idsOf, robotId, taken, type Role } from "./state";

interface TabProps<Result> {
  job: KnownJob<Result> | null;
  problem: Signal<Problem | null>;
  /** While it runs: what it is called, and what it does. */
  title: string;
  about: string;
  /** What was called off, as `The diagnosis`. */
  name: string;
  cancel: () => Promise<void>;
  /** Back to the recordings. */
  again: () => void;
  /** What is asked before there is a job. */
  ask: ComponentChildren;
  found: (result: Result) => ComponentChildren;
  /** More about a refusal than its words. */
  refused?: (problem: Problem) => ComponentChildren;
}

export function JobTab<Result>({ job, problem, title, about, name, cancel, again, ask, found, refused }: TabProps<Result>) {
  const refusal = job?.state === "failed" && job.problem ? new Problem(job.problem) : null;
  return (
    <div class="diagnose">
      {problem.value && <ProblemCard problem={problem.value} close={() => (problem.value = null)} />}
      {!job && ask}
      {job && (job.state === "queued" || job.state === "running") && <UnderWay title={title} about={about} job={job} cancel={cancel} />}
      {job?.state === "done" && job.result && found(job.result)}
      {refusal && <ProblemCard problem={refusal} retry={again} retryName="Back to the recordings" />}
      {refusal && refused?.(refusal)}
      {job?.state === "cancelled" && (
        <div class="notice">
          <p>{name} was called off.</p>
          <button type="button" class="primary" onClick={again}>
            Back to the recordings
          </button>
        </div>
      )}
    </div>
  );
}

interface AskProps {
  title: string;
  about: ComponentChildren;
  roles: Role[];
  /** What is still needed while there is no recording at all. */
  needed: string;
  /** What the button says. */
  act: string;
  begin: () => Promise<void>;
}

/** Recordings, the robot that drove, the ground that it drove on, and the button that begins. */
export function Ask({ title, about, roles, needed, act, begin }: AskProps) {
  const isReady = idsOf("suspect").length > 0 && taken.value.every((one) => one.recording || one.problem);
  return (
    <>
      <header class="diagnose-head">
        <h2>{title}</h2>
        <p>{about}</p>
      </header>
      <Recordings roles={roles} />
      <footer class="diagnose-start">
        <RobotSelect label="Robot that drove" value={robotId.value ?? plan.robotId.value} choose={(id) => (robotId.value = id)} />
        <GroundSelect />
        <button type="button" class="primary" disabled={!isReady} onClick={() => void begin()}>
          {act}
        </button>
        {!isReady && <small>{taken.value.length === 0 ? needed : "Waiting for a recording that can be read and is ticked."}</small>}
      </footer>
    </>
  );
}

/** The ground of recordings that do not name theirs. */
function GroundSelect() {
  const { robot, ground: chosen } = drove.value;
  const names = Object.keys(robot?.surfaces ?? {});
  if (!robot || names.length < 2) return null;
  return (
    <label class="field" title="Where recordings do not name it">
      <span>on</span>
      <select
        aria-label="Ground that was driven"
        value={chosen ?? robot.default_surface}
        onChange={(event) => {
          const name = event.currentTarget.value;
          ground.value = name === robot.default_surface ? null : name;
        }}
      >
        {names.map((name) => (
          <option key={name} value={name}>
            {words(name)}
          </option>
        ))}
      </select>
    </label>
  );
}
