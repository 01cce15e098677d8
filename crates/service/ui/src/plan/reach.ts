/** Energy contours: how far so much energy goes. A service that has none is not asked, and the page does not offer them. */
import { effect } from "@preact/signals";
import { ask, isAbort } from "../api/ask";
import { problemOf } from "../api/problem";
import { reachable, type ReachQuestion } from "../api/reachable";
import type { Robot } from "../api/robots";
import { J_PER_WH, USUAL_RESERVE } from "./charge";
import * as state from "./state";

/** About so many contours are drawn. */
const CONTOURS = 8;

/** Beyond the path's own energy contours go on for this share of it. */
const BEYOND = 1.25;

/** Round steps of energy, up to somewhat more than the path takes; but no more than the charge gives, which is a contour too. */
export function energiesOf(robot: Robot, charge: number, path_j: number | undefined): number[] {
  const { battery } = robot;
  const available_j = battery ? (charge - (battery.reserve_fraction ?? USUAL_RESERVE)) * battery.capacity_wh * J_PER_WH : Infinity;
  const most_j = Math.min(available_j, path_j && path_j > 0 ? BEYOND * path_j : available_j);
  if (!(most_j > 0) || !Number.isFinite(most_j)) return [];
  const rough_j = most_j / CONTOURS;
  const power = 10 ** Math.floor(Math.log10(rough_j));
  const step_j = power * ([1, 2, 5, 10].find((round) => round * power >= rough_j) ?? 10);
  const steps = Array.from({ length: Math.floor(most_j / step_j) }, (_, i) => (i + 1) * step_j);
  return most_j === available_j && steps.at(-1) !== available_j ? [...steps, available_j] : steps;
}

let latest = new AbortController();

async function draw(question: ReachQuestion, signal: AbortSignal): Promise<void> {
  try {
    const found = await reachable(question, { signal });
    if (!signal.aborted) state.contours.value = found;
  } catch (thrown) {
    if (signal.aborted || isAbort(thrown)) return;
    state.contours.value = [];
    state.problem.value = problemOf(thrown);
  }
}

/** Begins to follow what contours are wanted. */
export function followReach(): void {
  void ask<{ paths: Record<string, unknown> }>("/openapi.json").then(
    ({ paths }) => (state.hasReach.value = "/v1/reachable" in paths),
    () => undefined,
  );
  effect(() => {
    const [map, robot, start, kind] = [state.map.value, state.robot.value, state.start.value, state.reach.value];
    const [isHeld, charge, path_j] = [state.isDragging.value, state.charge.value, state.comparison.value?.energy.energy_j];
    if (!kind || !state.hasReach.value || !map || !robot || !start) {
      latest.abort();
      state.contours.value = [];
      return;
    }
    // They take longer than a path: while a slider moves, the old ones stay.
    if (isHeld) return;
    latest.abort();
    latest = new AbortController();
    const energies_j = energiesOf(robot.robot, charge, path_j);
    const speed_mps = state.speed_mps.value;
    const question = { map_id: map.id, robot: state.loaded(robot), start, kind, energies_j, ...(speed_mps !== null && { speed_mps }) };
    if (energies_j.length > 0) void draw(question, latest.signal);
    else state.contours.value = [];
  });
}
