/** Asks anew whenever the question changes; an answer that is no longer wanted is called off. */
import { batch, effect, untracked } from "@preact/signals";
import { announce } from "../announce";
import { isAbort } from "../api/ask";
import { compare, type PlanQuestion } from "../api/plans";
import { problemOf } from "../api/problem";
import { percent, energy } from "../format";
import { steeredGoal, steering } from "./steering";
import * as state from "./state";

/** While a slider or a marker moves, paths of the lattice within 5 % of the least will do: they come at once. */
const WHILE_DRAGGED = { bound: 1.05, refine: false };

/** The question that the page asks now, for a robot; null while something is missing. */
export function question(known = state.robot.value): PlanQuestion | null {
  const [map, start, goal] = [state.map.value, state.start.value, state.goal.value];
  if (state.journey.value === "stops" || !map || !known || !start || !goal) return null;
  const speed_mps = state.speed_mps.value;
  return {
    map_id: map.id,
    robot: state.loaded(known),
    start,
    goal: steeredGoal(goal),
    ...steering.value,
    ...(speed_mps !== null && { speed_mps: Math.min(speed_mps, known.robot.max_wheel_speed_mps) }),
  };
}

/** A question, and the same for the robot before a correction where there is one. */
interface Asked {
  now: PlanQuestion;
  former: PlanQuestion | null;
}

/** While a slider moves, an answer under way is given so long before a newer question takes its place: were each step to
 * call off the one before, none would ever come. */
const DRAGGED_PATIENCE_MS = 2000;

let running: { controller: AbortController; since: number } | null = null;
let waiting: { asked: Asked; timer: ReturnType<typeof setTimeout> } | null = null;

function stop(): void {
  clearTimeout(waiting?.timer);
  waiting = null;
  running?.controller.abort();
  running = null;
}

function begin(asked: Asked): void {
  stop();
  const controller = new AbortController();
  running = { controller, since: performance.now() };
  state.isPlanning.value = true;
  void answer(asked, controller.signal).finally(() => {
    if (running?.controller !== controller) return;
    running = null;
    if (waiting) begin(waiting.asked);
    else state.isPlanning.value = false;
  });
}

function askSoon(asked: Asked): void {
  if (!running || !state.isDragging.peek()) {
    begin(asked);
    return;
  }
  clearTimeout(waiting?.timer);
  const left_ms = Math.max(0, running.since + DRAGGED_PATIENCE_MS - performance.now());
  waiting = { asked, timer: setTimeout(() => begin(asked), left_ms) };
}

async function answer({ now, former }: Asked, signal: AbortSignal): Promise<void> {
  try {
    const [found, before] = await Promise.all([compare(now, { signal }), former && compare(former, { signal })]);
    if (signal.aborted) return;
    batch(() => {
      state.comparison.value = found;
      state.former.value = before?.energy ?? null;
      state.problem.value = null;
    });
    if (!state.isDragging.peek()) {
      announce(`The energy-minimal path takes ${energy(found.energy.energy_j)}, ${percent(found.saving_fraction)} less than the shortest.`);
    }
  } catch (thrown) {
    if (signal.aborted || isAbort(thrown)) return;
    batch(() => {
      state.problem.value = problemOf(thrown);
      state.comparison.value = null;
      state.former.value = null;
    });
  }
}

/** Begins to follow the question. */
export function followQuestion(): void {
  effect(() => {
    const asked = question();
    const formerRobot = state.robots.value?.find(({ id }) => id === state.formerId.value);
    const former = formerRobot ? question(formerRobot) : null;
    const rough = state.isDragging.value ? WHILE_DRAGGED : {};
    untracked(() => {
      if (asked) {
        askSoon({ now: { ...asked, ...rough }, former: former && { ...former, ...rough } });
        return;
      }
      stop();
      state.isPlanning.value = false;
      state.comparison.value = null;
      state.former.value = null;
    });
  });
}
