/** `/v1/mission` and `/v1/range`: several stops on a charge, and how likely the charge lasts. */
import { ask, type Asking } from "./ask";
import type { Warning } from "./maps";
import type { Place, Pose } from "./plans";
import type { Robot } from "./robots";

/** Median and central 90 % over draws of robot, battery and ground. */
export interface Spread {
  p05: number;
  p50: number;
  p95: number;
}

/** The part of the question that both have. */
interface OnACharge {
  map_id: string;
  robot: string | Robot;
  start: Place;
  /** Charge at the start, 0 to 1. */
  charge: number;
  return: boolean;
  reverse?: true;
  speed_mps?: number;
}

export type MissionQuestion = OnACharge & { waypoints: Place[] };
export type RangeQuestion = OnACharge & { goal: Place };

/** A stop of a mission, with the way there from the stop before. */
export interface MissionStop {
  kind: "start" | "waypoint" | "charger" | "home";
  /** Position of the waypoint in the question; null for start and home. */
  index: number | null;
  x_m: number;
  y_m: number;
  arrival_s: number;
  energy_j: number;
  arrival_charge: number;
  poses: Pose[];
}

export interface Mission {
  feasible: boolean;
  energy_j: Spread;
  arrival_charge: Spread;
  success_probability: number;
  missing_j: number;
  duration_s: number;
  distance_m: number;
  reserve_fraction: number;
  stops: MissionStop[];
  search: { ways_energy_j: number; least_energy_j: number; excess_at_most_j: number };
  warnings: Warning[];
}

export interface RangeAnswer {
  reachable: boolean;
  energy_j: Spread;
  arrival_charge: Spread;
  success_probability: number;
  missing_j: number;
  reserve_fraction: number;
  duration_s: number;
  distance_m: number;
  /** There, and back where that was asked for. */
  legs: { energy_j: number; distance_m: number; arrival_charge: number; poses: { x_m: number; y_m: number; z_m: number }[] }[];
  /** The last place to turn back. */
  turning_point?: { x_m: number; y_m: number; distance_m: number; charge: number; charge_at_home: number } | null;
  best_speed: { speed_mps: number; saving_j: number };
  warnings: Warning[];
}

export const planMission = (question: MissionQuestion, asking: Asking = {}) => ask<Mission>("/v1/mission", { ...asking, json: question });

export const findRange = (question: RangeQuestion, asking: Asking = {}) => ask<RangeAnswer>("/v1/range", { ...asking, json: question });
