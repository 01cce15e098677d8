/** What the Plan tab shows and asks, as signals. */
import { computed, signal } from "@preact/signals";
import type { Cells, MapSummary } from "../api/maps";
import type { Mission, RangeAnswer } from "../api/missions";
import type { Comparison, Objective, Place, Plan } from "../api/plans";
import type { Problem } from "../api/problem";
import type { Contour, ReachKind } from "../api/reachable";
import type { KnownRobot, Robot } from "../api/robots";

export type Layer = "elevation" | "slope" | "surface";
export type Tool = "start" | "goal" | "stops" | "move" | "areas" | "measure";
/** One goal with three paths compared, or several stops in the order of least energy. */
export type Journey = "goal" | "stops";
/** Whether the battery lasts is asked for the way there, or there and back. */
export type RangeKind = "there" | "return";

export const maps = signal<MapSummary[] | null>(null);
export const mapId = signal<string | null>(null);
export const map = computed(() => maps.value?.find(({ id }) => id === mapId.value) ?? null);
export const cells = signal<Cells | null>(null);

export const robots = signal<KnownRobot[] | null>(null);
export const robotId = signal("husky-a200-field");
export const robot = computed(() => robots.value?.find(({ id }) => id === robotId.value) ?? null);
/** The robot before a correction was accepted: its path is shown beside. */
export const formerId = signal<string | null>(null);

export const formerRobot = computed(() => robots.value?.find(({ id }) => id === formerId.value) ?? null);
/** Whether the robot beside is the same one before a diagnosis or a calibration. */
export const isCorrection = computed(() => / (corrected|calibrated)$/.test(robot.value?.robot.name ?? ""));

export const start = signal<Place | null>(null);
export const goal = signal<Place | null>(null);
export const journey = signal<Journey>("goal");
/** Places to visit, in the order in which they were given. */
export const stops = signal<Place[]>([]);
/** Whether the mission ends at its start. */
export const returnsHome = signal(false);
export const tool = signal<Tool>("start");

/** Null: what the service takes by itself. */
export const speed_mps = signal<number | null>(null);
export const payload_kg = signal(0);
/** Ground where the map names none; null: the robot's default. */
export const surface = signal<string | null>(null);
/** Charge at the start, 0 to 1. */
export const charge = signal(1);

export const layer = signal<Layer>("elevation");
export const is3d = signal(false);
/** Whether tiles of pictures lie on the ground. */
export const hasTiles = signal(false);

/** Which contours are wanted, and whether the service has any. */
export const reach = signal<ReachKind | null>(null);
export const hasReach = signal(false);
export const contours = signal<Contour[]>([]);

export const mission = signal<Mission | null>(null);
export const rangeKind = signal<RangeKind | null>(null);
export const range = signal<RangeAnswer | null>(null);

export const comparison = signal<Comparison | null>(null);
/** The former robot's energy-minimal path. */
export const former = signal<Plan | null>(null);
export const isPlanning = signal(false);
/** Whether a slider is held: answers may then be rough, but must be quick. */
export const isDragging = signal(false);
export const problem = signal<Problem | null>(null);

/** The path that charts and robot follow. */
export const focus = signal<Objective>("energy");
/** How far along it the robot is shown [m]; null: nowhere. */
export const along_m = signal<number | null>(null);

/** A robot with the load and ground of the sliders; by its name where they change nothing. */
export function loaded(known: KnownRobot): string | Robot {
  if (payload_kg.value === 0 && surface.value === null) return known.id;
  const ground = surface.value && surface.value in known.robot.surfaces ? surface.value : known.robot.default_surface;
  return { ...known.robot, mass_kg: known.robot.mass_kg + payload_kg.value, default_surface: ground };
}

/** The planner drives at half the wheels' top speed unless told otherwise. */
export const usualSpeed = (of: Robot) => of.max_wheel_speed_mps / 2;
