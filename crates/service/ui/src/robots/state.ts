/** The robot that is being looked at and edited. */
import { computed, effect, signal } from "@preact/signals";
import { announce } from "../announce";
import { problemOf, type Problem } from "../api/problem";
import { deleteRobot, listMechanisms, storeRobot, type MechanismRanges, type Robot } from "../api/robots";
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

/** What mechanisms may be on a robot, by its id. */
const ranges = signal<{ id: string; mechanisms: MechanismRanges[] } | null>(null);

/** What mechanisms may be on the robot shown. Loads and forces grow with its mass: while that is edited, only the service knows. */
export const mechanismRanges = computed<MechanismRanges[]>(() => {
  const [stored, stated] = [known.value, ranges.value];
  return stored && stated?.id === stored.id && shown.value?.mass_kg === stored.robot.mass_kg ? stated.mechanisms : [];
});

const carriesMechanisms = ({ mechanisms, surfaces }: Robot) =>
  [mechanisms, ...Object.values(surfaces).map((surface) => surface.mechanisms)].some((list) => Array.isArray(list) && list.length > 0);

/** Asks for the ranges of a robot that carries mechanisms. Without an answer they are open: the service refuses what cannot be. */
effect(() => {
  const stored = known.value;
  if (!stored || !carriesMechanisms(stored.robot) || ranges.peek()?.id === stored.id) return;
  listMechanisms(stored.id).then(
    (mechanisms) => (ranges.value = { id: stored.id, mechanisms }),
    () => undefined,
  );
});

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
