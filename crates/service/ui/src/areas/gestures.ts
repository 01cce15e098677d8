/** Mouse and fingers on the map while areas are edited. */
import type { Position } from "../api/areas";
import { cursor } from "../map/cursor";
import { toMetres, toPixel, type Point } from "../map/view";
import { addCorner, canFinish, drop, finish, select } from "./edit";
import { areaAt, cornerAt, dragged, position, type Part, type Press } from "./shape";
import * as state from "./state";

/** A press on the map: a corner to come, a part that is dragged, or nothing of an area. */
export type AreaPress = { kind: "corner"; at: Press } | { kind: "drag"; part: Part; from: Position; at: Press; isMoving: boolean };

/** A shape ends where its last or first corner is pressed again, as by a double click: nearer than what hits an area, by this share,
 * so that narrow shapes can be drawn. */
const ENDING_SHARE = 0.5;

const placeOf = ({ view, size, point }: Press): Position => position(toMetres(view, size, point));

function endsAt(press: Press, corner: Position | undefined): boolean {
  if (!corner) return false;
  const { x, y } = toPixel(press.view, press.size, ...corner);
  return Math.hypot(x - press.point.x, y - press.point.y) <= ENDING_SHARE * press.within;
}

/** What a press begins; null where the map is to be panned. */
export function pressed(press: Press): AreaPress | null {
  cursor.value = null;
  if (state.mode.value !== "select") return { kind: "corner", at: press };
  const from = placeOf(press);
  const own = state.selectedArea.value;
  const corner = own && cornerAt(own.geometry, press);
  if (corner) return { kind: "drag", part: corner, from, at: press, isMoving: false };
  const index = areaAt(state.areas.value, from, press);
  select(index);
  return index === null ? null : { kind: "drag", part: "all", from, at: press, isMoving: false };
}

/** A pointer that goes further than this is dragging. */
const DRAG_PX = 6;

/** Follows a drag. Returns whether a press for a corner has become one that pans. */
export function moved(doing: AreaPress, point: Point): boolean {
  const { at } = doing;
  const isFar = Math.hypot(point.x - at.point.x, point.y - at.point.y) > DRAG_PX;
  if (doing.kind === "corner") return isFar;
  const own = state.selectedArea.value;
  doing.isMoving ||= isFar;
  if (own && doing.isMoving) state.preview.value = dragged(own.geometry, doing.part, doing.from, placeOf({ ...at, point }));
  return false;
}

/** The pointer is lifted: a corner is set, a shape ended, or a drag is done. */
export function released(doing: AreaPress): void {
  if (doing.kind === "drag") {
    drop();
    return;
  }
  const corners = state.corners.value;
  const { at } = doing;
  if (endsAt(at, corners.at(-1))) finish();
  else if (canFinish() && state.mode.value === "polygon" && endsAt(at, corners[0])) finish();
  else addCorner(placeOf(at));
}
