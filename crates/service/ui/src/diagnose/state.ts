/** Recordings at hand, the job under way, and its report. */
import { effect, signal } from "@preact/signals";
import { announce } from "../announce";
import { cancelJob, followJob, readJob, startDiagnosis, type Job } from "../api/jobs";
import { Problem, problemOf } from "../api/problem";
import { storeRecording, type StoredRecording } from "../api/recordings";
import { storeRobot } from "../api/robots";
import { loadRobots } from "../plan/load";
import * as plan from "../plan/state";
import { tab } from "../tab";
import type { Report } from "./report";

export type Role = "suspect" | "healthy";

/** A file that was dropped: on its way, read, or refused. */
export interface Taken {
  key: number;
  name: string;
  bytes: number;
  role: Role;
  share: number;
  recording?: StoredRecording;
  problem?: Problem;
}

export const taken = signal<Taken[]>([]);
/** The job; of one that a link names only the id is known at first. */
export const job = signal<(Partial<Job<Report>> & Pick<Job<Report>, "id" | "state">) | null>(null);
export const problem = signal<Problem | null>(null);
export const robotId = signal<string | null>(null);

let count = 0;

function change(key: number, with_: Partial<Taken>): void {
  taken.value = taken.value.map((one) => (one.key === key ? { ...one, ...with_ } : one));
}

export function take(files: File[], role: Role): void {
  for (const file of files) {
    const key = count++;
    taken.value = [...taken.value, { key, name: file.name, bytes: file.size, role, share: 0 }];
    storeRecording(file, (share) => change(key, { share })).then(
      (recording) => {
        change(key, { recording });
        announce(`${file.name} is read: ${recording.rows} rows.`);
      },
      (thrown) => change(key, { problem: problemOf(thrown) }),
    );
  }
}

export function takeStored(recording: StoredRecording, role: Role): void {
  const name = `${recording.report.source}.${recording.format}`;
  taken.value = [...taken.value, { key: count++, name, bytes: recording.bytes, role, share: 1, recording }];
}

export function leave(key: number): void {
  taken.value = taken.value.filter((one) => one.key !== key);
}

export const idsOf = (role: Role) => taken.value.flatMap((one) => (one.role === role && one.recording ? [one.recording.id] : []));

export async function begin(): Promise<void> {
  problem.value = null;
  try {
    const robot = robotId.value ?? plan.robotId.value;
    job.value = await startDiagnosis<Report>({ robot, recordings: idsOf("suspect"), reference: idsOf("healthy") });
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

export async function cancel(): Promise<void> {
  const { id } = job.value ?? {};
  if (!id) return;
  await cancelJob<Report>(id).catch((thrown: unknown) => (problem.value = problemOf(thrown)));
}

/** Back to the recordings. */
export function again(): void {
  job.value = null;
  problem.value = null;
}

/** Stores the corrected robot and plans with it, beside the path of the robot before. */
export async function accept(report: Report): Promise<void> {
  problem.value = null;
  try {
    const before = robotId.value ?? plan.robotId.value;
    const name = `${report.robot.name.replace(/, corrected$/, "")}, corrected`;
    const stored = await storeRobot({ ...report.robot, name });
    await loadRobots();
    plan.formerId.value = before === stored.id ? null : before;
    plan.robotId.value = stored.id;
    tab.value = "plan";
    announce(`${name} is stored; the plan now uses it.`);
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

/** Begins to follow whichever job there is. */
export function followJobs(): void {
  let followed = "";
  let stop = () => {};
  effect(() => {
    const { id = "", state } = job.value ?? {};
    if (id === followed || (state && state !== "queued" && state !== "running")) return;
    stop();
    followed = id;
    if (!id) return;
    const told = (now: Job<Report>) => {
      if (job.peek()?.id === id) job.value = now;
      if (now.state === "done" && now.result) announce(now.result.sentence);
    };
    // The events of a job that is not there fail without a word; asking for it says why.
    readJob<Report>(id).then(
      (now) => {
        told(now);
        if (now.state === "queued" || now.state === "running")
          stop = followJob<Report>(id, told, (thrown) => (problem.value = problemOf(thrown)));
      },
      (thrown) => {
        problem.value = problemOf(thrown);
        job.value = null;
      },
    );
  });
}
