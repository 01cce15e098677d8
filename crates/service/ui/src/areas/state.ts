/** The areas of the chosen map, and what is being done with them, as signals. */
import { computed, signal } from "@preact/signals";
import type { Area, AreaProperties, Geometry, Position } from "../api/areas";
import type { MapSummary } from "../api/maps";
import type { Problem } from "../api/problem";
import * as plan from "../plan/state";
import { USUAL, type Kind } from "./effects";

export type Mode = "select" | "polygon" | "line";

/** A map with its areas. */
export interface Version {
  map: MapSummary;
  areas: Area[];
}

/** What is shown; while a change is being stored, it is shown already. */
export const version = signal<Version | null>(null);
export const areas = computed(() => version.value?.areas ?? []);
/** Versions that undo and redo lead to, the nearest last. */
export const past = signal<Version[]>([]);
export const future = signal<Version[]>([]);
export const isStoring = signal(false);
export const problem = signal<Problem | null>(null);

export const isEditing = computed(() => plan.tool.value === "areas");
export const mode = signal<Mode>("polygon");
/** Corners of the shape that is being drawn. */
export const corners = signal<Position[]>([]);
export const selected = signal<number | null>(null);
export const selectedArea = computed(() => (selected.value === null ? null : (areas.value[selected.value] ?? null)));
/** The selected shape while it is dragged. */
export const preview = signal<Geometry | null>(null);

/** The effect of the area that is drawn next. */
export const nextKind = signal<Kind>("keep_out");
export const nextValues = signal<Pick<AreaProperties, Kind>>(USUAL);

/** The value of a kind for the next area; where no surface is chosen yet, it is the robot's first. */
export function nextValue(kind: Kind): AreaProperties[Kind] {
  const value = nextValues.value[kind];
  return kind === "surface" ? (value ?? surfaceNames.value[0] ?? null) : value;
}

/** Names of the robot's surfaces. */
export const surfaceNames = computed(() => Object.keys(plan.robot.value?.robot.surfaces ?? {}));
