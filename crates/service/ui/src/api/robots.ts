/** Robots, as their files have them. */
import { ask, send } from "./ask";

export interface Motor {
  k1_w_per_n2: number;
  k2: number;
  force_n_per_a?: number;
}

export interface Surface {
  mu_roll: number;
  mu_skid: number;
  slip_angle_scale_rad?: number;
  dogru_marques?: unknown;
  mechanisms?: unknown;
}

export interface Robot {
  name: string;
  mass_kg: number;
  wheel_radius_m?: number;
  max_wheel_speed_mps: number;
  motors: { left: Motor; right: Motor; [field: string]: unknown };
  battery?: { capacity_wh: number; nominal_voltage_v: number; reserve_fraction?: number };
  limits: { max_pitch_rad: number; max_roll_rad: number; max_side_force_n?: number };
  surfaces: Record<string, Surface>;
  default_surface: string;
  [field: string]: unknown;
}

/** A robot by the name or id that requests may give for it. */
export interface KnownRobot {
  id: string;
  robot: Robot;
  isStored: boolean;
}

/** Built-in robots, then stored ones. */
export async function listRobots(): Promise<KnownRobot[]> {
  const { robots, stored = [] } = await ask<{ robots: Robot[]; stored?: { id: string; robot: Robot }[] }>("/v1/robots");
  return [
    ...robots.map((robot) => ({ id: robot.name, robot, isStored: false })),
    ...stored.map(({ id, robot }) => ({ id, robot, isStored: true })),
  ];
}

/** Stores a robot. */
export async function storeRobot(robot: unknown): Promise<KnownRobot> {
  return { ...(await ask<{ id: string; robot: Robot }>("/v1/robots", { json: robot })), isStored: true };
}

/** Deletes a stored robot. */
export async function deleteRobot(id: string): Promise<void> {
  await send(`/v1/robots/${id}`, { method: "DELETE" });
}

/** A parameter of a mechanism, with what it may be on a robot; its unit is `1` where it has none. */
export interface ParameterRange {
  name: string;
  unit: string;
  least: number;
  greatest: number;
  optional: boolean;
}

/** A mechanism that a robot's file may carry. */
export interface MechanismRanges {
  mechanism: string;
  parameters: ParameterRange[];
}

/** The mechanisms that a robot may carry, with what they may be on it. */
export async function listMechanisms(id: string): Promise<MechanismRanges[]> {
  return (await ask<{ mechanisms: MechanismRanges[] }>(`/v1/robots/${encodeURIComponent(id)}/mechanisms`)).mechanisms;
}
