/** The fit of a robot to recordings: asked for, followed, and taken up. */
import { signal } from "@preact/signals";
import { cancelJob, follow, startCalibration, type KnownJob } from "../api/jobs";
import { problemOf, type Problem } from "../api/problem";
import { accept as acceptRobot } from "../diagnose/accept";
import { drove, idsOf } from "../diagnose/state";
import { announce } from "../announce";
import type { Calibration } from "./report";

/** The job; of one that a link names only the id is known at first. */
export const job = signal<KnownJob<Calibration> | null>(null);
export const problem = signal<Problem | null>(null);

export async function begin(despite: string[] = []): Promise<void> {
  problem.value = null;
  try {
    job.value = await startCalibration<Calibration>({
      robot: drove.value.asked,
      recordings: idsOf("suspect"),
      ...(despite.length > 0 && { despite }),
    });
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

export async function cancel(): Promise<void> {
  if (job.value) await cancelJob(job.value.id).catch((thrown: unknown) => (problem.value = problemOf(thrown)));
}

/** Back to the recordings. */
export function again(): void {
  job.value = null;
  problem.value = null;
}

export async function accept({ robot }: Calibration): Promise<void> {
  problem.value = null;
  try {
    await acceptRobot(robot, "calibrated", drove.value);
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

export const followCalibration = () => follow(job, problem, () => announce("The robot is fitted to the drives."));
