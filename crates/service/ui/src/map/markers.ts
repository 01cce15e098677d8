/** The places that are marked on the map and in the 3-D view. */
import { computed } from "@preact/signals";
import type { RangeAnswer } from "../api/missions";
import type { Place } from "../api/plans";
import * as state from "../plan/state";
import { visitOf } from "./stops";

/** Ways shorter than this are no ways [m]. */
const NEXT_TO_M = 1;

/** Whether the last place to turn back comes before the goal. */
export const turnsEarly = ({ turning_point, legs }: RangeAnswer) =>
  !!turning_point && turning_point.distance_m < (legs[0]?.distance_m ?? 0) - NEXT_TO_M;

export interface Marker {
  place: Place;
  letter: string;
}

/** The start last, and so on top. */
export const markers = computed<Marker[]>(() => {
  const [start, goal, range] = [state.start.value, state.goal.value, state.range.value];
  const turning = range && turnsEarly(range) ? range.turning_point : null;
  const isMission = state.journey.value === "stops";
  const goals = isMission
    ? state.stops.value.map((place, i) => ({ place, letter: String(visitOf(i)) }))
    : [
        ...(turning ? [{ place: { x_m: turning.x_m, y_m: turning.y_m }, letter: "T" }] : []),
        ...(goal ? [{ place: goal, letter: "G" }] : []),
      ];
  return start ? [...goals, { place: start, letter: "S" }] : goals;
});
