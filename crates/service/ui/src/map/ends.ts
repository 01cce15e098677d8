/** Placing start and goal, however it is done. */
import { announce } from "../announce";
import type { Cells } from "../api/maps";
import type { Place } from "../api/plans";
import { metres } from "../format";
import * as state from "../plan/state";
import { degreesOf, degreesWords } from "./earth";
import { extentOf } from "./view";

export type End = "start" | "goal";

/** Elevation of the cell under a place [m]; NaN off the map. */
export function elevationAt(cells: Cells | null, x_m: number, y_m: number): number {
  if (!cells) return NaN;
  const column = Math.floor((x_m - cells.x_m) / cells.cell_size_m);
  const row = Math.floor((y_m - cells.y_m) / cells.cell_size_m);
  if (column < 0 || row < 0 || column >= cells.columns || row >= cells.rows) return NaN;
  return cells.z_m[row * cells.columns + column] ?? NaN;
}

/** A place in words, from the map's south-west corner. */
export function placeWords({ x_m, y_m }: Place): string {
  const map = state.map.value;
  if (!map) return "";
  const z_m = elevationAt(state.cells.value, x_m, y_m);
  const height = Number.isNaN(z_m) ? "" : `, ${metres(z_m)} up`;
  const degrees = degreesOf({ x_m, y_m });
  const onEarth = degrees ? `, ${degreesWords(degrees)}` : "";
  return `${metres(x_m - map.origin_m[0])} east, ${metres(y_m - map.origin_m[1])} north${height}${onEarth}`;
}

/** Keeps a place on the map. */
export function onMap(place: Place): Place {
  const map = state.map.value;
  if (!map) return place;
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  const half_m = map.cell_size_m / 2;
  const within = (value: number, least: number, length: number) => Math.min(Math.max(value, least + half_m), least + length - half_m);
  return { ...place, x_m: within(place.x_m, west_m, width_m), y_m: within(place.y_m, south_m, height_m) };
}

/** To the millimetre, as links write it: a link then means the very same place. */
export const rounded = (value_m: number) => Number(value_m.toFixed(3));

export function setEnd(end: End, place: Place): void {
  const { x_m, y_m, ...heading } = onMap(place);
  state[end].value = { x_m: rounded(x_m), y_m: rounded(y_m), ...heading };
  state.along_m.value = null;
}

/** An end is where it should be: says so, and goes on to the next. */
export function settle(end: End): void {
  const place = state[end].value;
  if (!place) return;
  announce(`${end === "start" ? "Start" : "Goal"}: ${placeWords(place)}.`);
  if (state.journey.value === "stops") state.tool.value = "stops";
  else state.tool.value = end === "start" && !state.goal.value ? "goal" : "move";
}

/** Turns an end; the planner knows sixteen headings. */
export function turn(end: End, steps: number): void {
  const place = state[end].value;
  if (!place) return;
  const heading_rad = ((place.heading_rad ?? 0) + (steps * Math.PI) / 8) % (2 * Math.PI);
  state[end].value = { ...place, heading_rad };
  announce(`Heading ${Math.round((heading_rad * 180) / Math.PI)} degrees`);
}
