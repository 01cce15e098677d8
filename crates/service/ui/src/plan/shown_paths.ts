/** The paths that map, charts and 3-D view show, whichever question they answer. */
import { computed } from "@preact/signals";
import type { Mission } from "../api/missions";
import { OBJECTIVES, type Objective, type Pose } from "../api/plans";
import type { STYLE } from "../map/draw";
import * as state from "./state";

export interface ShownPath {
  style: keyof typeof STYLE;
  poses: Pose[];
  distance_m: number;
  /** The objective whose row of the table chooses this path. */
  objective?: Objective;
}

/** The ways of a mission, one behind the other: distance, time and energy go on from way to way. */
export function joined({ stops }: Pick<Mission, "stops">): Pose[] {
  const [from, poses]: [{ distance_m: number; energy_j: number; t_s: number }, Pose[]] = [{ distance_m: 0, energy_j: 0, t_s: 0 }, []];
  for (const stop of stops) {
    for (const pose of stop.poses) {
      poses.push({
        ...pose,
        distance_m: from.distance_m + pose.distance_m,
        energy_j: from.energy_j + pose.energy_j,
        t_s: from.t_s + pose.t_s,
      });
    }
    const last = poses.at(-1);
    if (last) Object.assign(from, { distance_m: last.distance_m, energy_j: last.energy_j, t_s: last.t_s });
  }
  return poses;
}

/** The path that charts and robot follow; null where there is none. */
export const focusedPath = computed<ShownPath | null>(() => {
  if (state.journey.value === "stops") {
    const poses = state.mission.value ? joined(state.mission.value) : [];
    const distance_m = poses.at(-1)?.distance_m;
    return distance_m === undefined ? null : { style: "mission", poses, distance_m };
  }
  const objective = state.focus.value;
  const plan = state.comparison.value?.[objective];
  return plan ? { style: objective, objective, poses: plan.poses, distance_m: plan.distance_m } : null;
});

/** The paths that can be followed: the focused one last, and so on top. */
export const followedPaths = computed<ShownPath[]>(() => {
  const [focused, plans] = [focusedPath.value, state.comparison.value];
  if (!focused) return [];
  if (!plans || !focused.objective) return [focused];
  const others = [...OBJECTIVES].reverse().filter((objective) => objective !== focused.objective);
  const shown = others.map((objective) => ({
    style: objective,
    objective,
    poses: plans[objective].poses,
    distance_m: plans[objective].distance_m,
  }));
  return [...shown, focused];
});

/** A path that is drawn and not followed: that of the robot before its correction, or the way back. */
export interface Backdrop {
  style: keyof typeof STYLE;
  poses: { x_m: number; y_m: number; z_m: number }[];
}

export const backdrops = computed<Backdrop[]>(() => {
  if (state.journey.value === "stops") return [];
  const back = state.range.value?.legs[1];
  return [
    ...(state.former.value ? [{ style: "former" as const, poses: state.former.value.poses }] : []),
    ...(back ? [{ style: "back" as const, poses: back.poses }] : []),
  ];
});
