/** Asks for the mission over several stops, and whether the battery lasts to one goal, whenever the question changes. */
import { batch, computed, effect, signal, type Signal } from "@preact/signals";
import { announce } from "../announce";
import { isAbort } from "../api/ask";
import { findRange, planMission, type MissionQuestion, type RangeQuestion } from "../api/missions";
import { problemOf, type Problem } from "../api/problem";
import { duration, energy, percent } from "../format";
import { USUAL_RESERVE } from "./charge";
import { mayReverse } from "./steering";
import * as state from "./state";

export const isMissionPlanning = signal(false);
export const isRangePlanning = signal(false);
export const rangeProblem = signal<Problem | null>(null);

/** Why nothing can be driven on the charge, in words; null where something can. */
export const chargeFault = computed<string | null>(() => {
  const battery = state.robot.value?.robot.battery;
  if (!battery) return "The robot's file has no battery: add one under Robots.";
  const reserve = battery.reserve_fraction ?? USUAL_RESERVE;
  return state.charge.value > reserve
    ? null
    : `The charge of ${percent(state.charge.value)} is not above the reserve of ${percent(reserve)} that must stay.`;
});

/** The parts that mission and range have in common; null while something is missing. */
function onACharge() {
  const [map, known, start, speed_mps] = [state.map.value, state.robot.value, state.start.value, state.speed_mps.value];
  if (!map || !known || !start || chargeFault.value) return null;
  return {
    map_id: map.id,
    robot: state.loaded(known),
    start,
    charge: state.charge.value,
    ...(mayReverse.value && { reverse: true as const }),
    ...(speed_mps !== null && { speed_mps: Math.min(speed_mps, known.robot.max_wheel_speed_mps) }),
  };
}

/** The least number of ways of a mission: one way alone is a path to one goal. */
const LEAST_WAYS = 2;

export function missionQuestion(): MissionQuestion | null {
  const common = onACharge();
  const waypoints = state.stops.value;
  const ways = waypoints.length + Number(state.returnsHome.value);
  if (state.journey.value !== "stops" || !common || waypoints.length === 0 || ways < LEAST_WAYS) return null;
  return { ...common, waypoints, return: state.returnsHome.value };
}

function rangeQuestion(): RangeQuestion | null {
  const common = onACharge();
  const [goal, kind] = [state.goal.value, state.rangeKind.value];
  if (state.journey.value !== "goal" || !kind || !common || !goal) return null;
  return { ...common, goal, return: kind === "return" };
}

interface Following<Question, Answer> {
  question: () => Question | null;
  ask: (question: Question, signal: AbortSignal) => Promise<Answer>;
  answer: Signal<Answer | null>;
  problem: Signal<Problem | null>;
  isPlanning: Signal<boolean>;
  words: (answer: Answer) => string;
}

/** Follows a question; while a slider or a place is held, the answer before it stays. */
function follow<Question, Answer>({ question, ask, answer, problem, isPlanning, words }: Following<Question, Answer>): void {
  let latest = new AbortController();
  let asked = "";
  effect(() => {
    const now = question();
    if (now && state.isDragging.value) return;
    const text = JSON.stringify(now);
    if (text === asked) return;
    asked = text;
    latest.abort();
    latest = new AbortController();
    isPlanning.value = now !== null;
    if (!now) {
      answer.value = null;
      return;
    }
    const { signal } = latest;
    const done = (found: Answer | null, failure: Problem | null) =>
      batch(() => {
        isPlanning.value = false;
        answer.value = found;
        problem.value = failure;
        if (found) announce(words(found));
      });
    ask(now, signal).then(
      (found) => signal.aborted || done(found, null),
      (thrown) => {
        if (signal.aborted || isAbort(thrown)) return;
        asked = "";
        done(null, problemOf(thrown));
      },
    );
  });
}

/** Begins to follow both. */
export function followMission(): void {
  follow({
    question: missionQuestion,
    ask: (question, signal) => planMission(question, { signal }),
    answer: state.mission,
    problem: state.problem,
    isPlanning: isMissionPlanning,
    words: ({ energy_j, duration_s }) => `The mission takes ${energy(energy_j.p50)} and ${duration(duration_s)}.`,
  });
  follow({
    question: rangeQuestion,
    ask: (question, signal) => findRange(question, { signal }),
    answer: state.range,
    problem: rangeProblem,
    isPlanning: isRangePlanning,
    words: ({ success_probability }) => `The battery lasts with a probability of ${percent(success_probability)}.`,
  });
}
