/** The robot that is being looked at and edited. */
import { computed, signal } from "@preact/signals";
import { announce } from "../announce";
import { problemOf, type Problem } from "../api/problem";
import { deleteRobot, storeRobot, type Robot } from "../api/robots";
import { loadRobots } from "../plan/load";
import * as plan from "../plan/state";
import { tab } from "../tab";

/** Which robot is shown; null until one is chosen. */
export const shownId = signal<string | null>(null);
/** The robot as edited; null while it is as stored. */
export const edited = signal<Robot | null>(null);
export const problem = signal<Problem | null>(null);
export const isSaving = signal(false);

const known = computed(() => plan.robots.value?.find(({ id }) => id === (shownId.value ?? plan.robotId.value)) ?? null);
export const shown = computed<Robot | null>(() => edited.value ?? known.value?.robot ?? null);
export const knownShown = known;

export function choose(id: string): void {
  shownId.value = id;
  deletingId.value = null;
  edited.value = null;
  problem.value = null;
}

export async function save(): Promise<void> {
  const robot = shown.value;
  if (!robot) return;
  isSaving.value = true;
  try {
    const stored = await storeRobot(robot);
    await loadRobots();
    choose(stored.id);
    announce(`${stored.robot.name} is stored.`);
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
  isSaving.value = false;
}

/** Takes up a robot's file to look at and save; the service says what is wrong with it. */
export async function open(file: File): Promise<void> {
  problem.value = null;
  try {
    edited.value = JSON.parse(await file.text()) as Robot;
    await save();
  } catch {
    problem.value = problemOf(new Error(`${file.name} is not JSON: give a robot's file, as "Download" here writes it.`));
  }
}

/** The robot whose deletion waits to be confirmed. */
export const deletingId = signal<string | null>(null);

/** Deletes the robot shown, after it was asked for twice. */
export async function remove(): Promise<void> {
  const robot = known.value;
  if (!robot?.isStored) return;
  if (deletingId.value !== robot.id) {
    deletingId.value = robot.id;
    return;
  }
  deletingId.value = null;
  try {
    await deleteRobot(robot.id);
    if (plan.formerId.value === robot.id) plan.formerId.value = null;
    await loadRobots();
    choose(plan.robotId.value);
    announce(`${robot.robot.name} is deleted.`);
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

/** Plans with the robot shown. */
export function use(): void {
  const id = known.value?.id;
  if (!id) return;
  plan.robotId.value = id;
  plan.formerId.value = null;
  tab.value = "plan";
}
