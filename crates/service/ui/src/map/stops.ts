/** Placing, moving and removing the stops of a mission, however it is done. */
import { announce } from "../announce";
import type { Place } from "../api/plans";
import * as state from "../plan/state";
import { onMap, placeWords, rounded } from "./ends";

/** The service takes up to so many stops and chargers. */
export const MOST_STOPS = 50;

const kept = (place: Place): Place => {
  const { x_m, y_m, ...heading } = onMap(place);
  return { x_m: rounded(x_m), y_m: rounded(y_m), ...heading };
};

export function addStop(place: Place): void {
  if (state.stops.value.length >= MOST_STOPS) {
    announce(`There are ${MOST_STOPS} stops, and no more can be planned.`);
    return;
  }
  state.stops.value = [...state.stops.value, kept(place)];
  state.along_m.value = null;
  announce(`Stop ${state.stops.value.length}: ${placeWords(place)}.`);
}

export function moveStop(index: number, place: Place): void {
  state.stops.value = state.stops.value.map((each, i) => (i === index ? kept({ ...each, ...place }) : each));
}

export function removeStop(index: number): void {
  state.stops.value = state.stops.value.filter((_, i) => i !== index);
  announce(`Stop ${index + 1} is removed.`);
}

/** The number that a stop has on the map: its place in the order of visits, or before that is known in the order given. */
export function visitOf(index: number): number {
  const visits = state.mission.value?.stops.findIndex((stop) => stop.kind === "waypoint" && stop.index === index) ?? -1;
  return visits > 0 ? visits : index + 1;
}

/** Goes over to several stops, of which the goal becomes the first, or back to one goal. */
export function chooseJourney(journey: state.Journey): void {
  if (journey === state.journey.value) return;
  state.problem.value = null;
  state.along_m.value = null;
  if (journey === "stops") {
    const goal = state.goal.value;
    if (goal && state.stops.value.length === 0) state.stops.value = [{ x_m: goal.x_m, y_m: goal.y_m }];
    state.tool.value = state.start.value ? "stops" : "start";
  } else {
    state.goal.value ??= state.stops.value.at(-1) ?? null;
    state.tool.value = state.start.value ? (state.goal.value ? "move" : "goal") : "start";
  }
  state.journey.value = journey;
}
