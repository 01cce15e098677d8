/** What `/v1/compare` and `/v1/plan` take and answer; names are those of /openapi.json. */
import type { Warning } from "./maps";
import { ask, type Asking } from "./ask";
import type { Robot } from "./robots";

export interface Place {
  x_m: number;
  y_m: number;
  heading_rad?: number;
}

export interface PlanQuestion {
  map_id: string;
  /** A built-in name, a stored id, or the robot itself. */
  robot: string | Robot;
  start: Place;
  goal: Place;
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

export interface Plan {
  energy_j: number;
  energy_interval_j: [number, number];
  duration_s: number;
  distance_m: number;
  climb_m: number;
  recovered_j: number;
  poses: Pose[];
  snapped: { start: { distance_m: number }; goal: { distance_m: number } };
  search: { bound: number | null; optimal: boolean; timed_out: boolean };
  warnings: Warning[];
}

/** The objectives, in the order in which they are shown. */
export const OBJECTIVES = ["energy", "distance", "time"] as const;
export type Objective = (typeof OBJECTIVES)[number];

export type Comparison = Record<Objective, Plan> & { saving_fraction: number };

/** Asks for the energy-minimal, shortest and fastest paths. */
export const compare = (question: PlanQuestion, asking: Asking = {}) => ask<Comparison>("/v1/compare", { ...asking, json: question });
