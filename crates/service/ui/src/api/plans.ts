/** What `/v1/compare` and `/v1/plan` take and answer; names are those of /openapi.json. */
import type { Warning } from "./maps";
import { ask, type Asking } from "./ask";
import { Problem } from "./problem";
import type { Robot } from "./robots";

export interface Place {
  x_m: number;
  y_m: number;
  heading_rad?: number;
}

/** How a path is steered; what is absent is as the service takes it. */
export interface Steering {
  reverse?: true;
  forbid?: "spin"[];
  /** No turn is tighter. */
  least_radius_m?: number;
  prices?: { stops: true };
  /** As near to the goal as can be, where no path leads to it. */
  partial?: true;
}

export interface PlanQuestion extends Steering {
  map_id: string;
  /** A built-in name, a stored id, or the robot itself. */
  robot: string | Robot;
  start: Place;
  goal: Place & { heading?: "either" };
  speed_mps?: number;
  bound?: number;
  refine?: boolean;
}

export interface Pose {
  x_m: number;
  y_m: number;
  z_m: number;
  heading_rad: number;
  t_s: number;
  distance_m: number;
  energy_j: number;
  power_w: number;
  pitch_rad: number;
}

/** A path that is shown: refined, where the answer has it so. */
export interface Plan {
  energy_j: number;
  energy_interval_j: [number, number];
  duration_s: number;
  distance_m: number;
  climb_m: number;
  /** How far from the goal a partial path ends. */
  short_of_goal_m?: number;
  recovered_j: number;
  /** Energy of the lattice's path, of which `search` says what is proven. */
  lattice_energy_j: number;
  /** False where time ran out while the path was refined; absent where it is the lattice's own. */
  finished?: boolean;
  poses: Pose[];
  snapped: { start: { distance_m: number }; goal: { distance_m: number } };
  search: { bound: number | null; excess_at_most: number; optimal: boolean; timed_out: boolean };
  warnings: Warning[];
}

/** A path as the service answers it: that of the lattice, and the refined one beside it. */
type Answered = Omit<Plan, "lattice_energy_j" | "finished"> & {
  refined?: Pick<Plan, "energy_j" | "energy_interval_j" | "duration_s" | "distance_m" | "climb_m" | "recovered_j" | "poses"> & {
    finished: boolean;
  };
};

/** The refined path with what is said of the lattice's, or that of the lattice where there is no other. */
function shown({ refined, ...plan }: Answered): Plan {
  return { ...plan, ...refined, lattice_energy_j: plan.energy_j };
}

/** What the first of two paths saves, as a share of the size of the other's energy. */
function saved(path: Plan, other: Plan): number {
  const saved_j = other.energy_j - path.energy_j;
  return other.energy_j === 0 ? 0 : saved_j / Math.abs(other.energy_j);
}

/** The objectives, in the order in which they are shown. */
export const OBJECTIVES = ["energy", "distance", "time"] as const;
export type Objective = (typeof OBJECTIVES)[number];

export type Comparison = Record<Objective, Plan> & { saving_fraction: number };

/** Asks for the energy-minimal, shortest and fastest paths; partial ones where that is asked for and no path leads to the goal. */
export async function compare({ partial, ...question }: PlanQuestion, asking: Asking = {}): Promise<Comparison> {
  const of = (answered: Record<Objective, Answered>): Comparison => {
    const [energy, distance, time] = [shown(answered.energy), shown(answered.distance), shown(answered.time)];
    return { energy, distance, time, saving_fraction: saved(energy, distance) };
  };
  try {
    return of(await ask<Record<Objective, Answered>>("/v1/compare", { ...asking, json: question }));
  } catch (thrown) {
    if (!partial || !(thrown instanceof Problem) || thrown.document.type.split("/").at(-1) !== "no-path") throw thrown;
    const plan = (objective: Objective) => ask<Answered>("/v1/plan", { ...asking, json: { ...question, partial, objective } });
    const [energy, distance, time] = await Promise.all([plan("energy"), plan("distance"), plan("time")]);
    return of({ energy, distance, time });
  }
}
