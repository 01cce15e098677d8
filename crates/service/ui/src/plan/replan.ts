/** Asks anew whenever the question changes; an answer that is no longer wanted is called off. */
import { effect } from "@preact/signals";
import { announce } from "../announce";
import { isAbort } from "../api/ask";
import { compare, type PlanQuestion } from "../api/plans";
import { problemOf } from "../api/problem";
import { percent, energy } from "../format";
import * as state from "./state";

/** While a slider moves, paths within 5 % of the least will do: they come at once. */
const DRAGGED_BOUND = 1.05;

/** The question that the page asks now, for a robot; null while something is missing. */
export function question(known = state.robot.value): PlanQuestion | null {
  const [map, start, goal] = [state.map.value, state.start.value, state.goal.value];
  if (!map || !known || !start || !goal) return null;
  const speed_mps = state.speed_mps.value;
  return {
    map_id: map.id,
    robot: state.loaded(known),
    start,
    goal,
    refine: false,
    ...(speed_mps !== null && { speed_mps: Math.min(speed_mps, known.robot.max_wheel_speed_mps) }),
  };
}

let latest = new AbortController();

async function answer(asked: PlanQuestion, earlier: PlanQuestion | null, signal: AbortSignal): Promise<void> {
  try {
    const [found, before] = await Promise.all([compare(asked, { signal }), earlier && compare(earlier, { signal })]);
    if (signal.aborted) return;
    state.comparison.value = found;
    state.former.value = before?.energy ?? null;
    state.problem.value = null;
    if (!state.isDragging.value) {
      announce(`The energy-minimal path takes ${energy(found.energy.energy_j)}, ${percent(found.saving_fraction)} less than the shortest.`);
    }
  } catch (thrown) {
    if (signal.aborted || isAbort(thrown)) return;
    state.problem.value = problemOf(thrown);
    state.comparison.value = null;
    state.former.value = null;
  }
  state.isPlanning.value = false;
}

/** Begins to follow the question. */
export function followQuestion(): void {
  effect(() => {
    const asked = question();
    const formerRobot = state.robots.value?.find(({ id }) => id === state.formerId.value);
    const earlier = formerRobot ? question(formerRobot) : null;
    const bound = state.isDragging.value ? { bound: DRAGGED_BOUND } : {};
    latest.abort();
    if (!asked) {
      state.comparison.value = null;
      state.isPlanning.value = false;
      return;
    }
    latest = new AbortController();
    state.isPlanning.value = true;
    void answer({ ...asked, ...bound }, earlier && { ...earlier, ...bound }, latest.signal);
  });
}
