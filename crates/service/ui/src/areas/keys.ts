/** Areas by keyboard: Enter sets corners, takes hold of areas and lets them go. */
import { effect, signal } from "@preact/signals";
import { announce } from "../announce";
import type { Position } from "../api/areas";
import { cursor } from "../map/cursor";
import { toPixel, type Size, type View } from "../map/view";
import { redo, undo } from "./changes";
import { addCorner, drop, finish, giveUp, removeSelected, select, takeCornerBack } from "./edit";
import { areaAt, cornerAt, dragged, position, type Part } from "./shape";
import * as state from "./state";

export const AREA_KEYS =
  "Arrow keys move the cursor, with Shift further. Enter sets a corner, and at the last or first one ends the shape; Backspace takes a corner back, Escape gives up. " +
  "To select: Enter selects the area at the cursor, takes hold of it or of a corner, and lets it go; Delete removes it. Ctrl+Z undoes, Ctrl+Shift+Z does again.";

/** Pixels within which the cursor is at a corner or a line. */
const NEAR_PX = 12;

/** The part of the selected area that the cursor carries. */
const held = signal<{ part: Part; from: Position } | null>(null);

effect(() => {
  const [carried, at, own] = [held.value, cursor.value, state.selectedArea.value];
  if (!carried) return;
  if (!own || !at) {
    held.value = null;
    state.preview.value = null;
    return;
  }
  state.preview.value = dragged(own.geometry, carried.part, carried.from, position(at));
});

function enterSelects(view: View, size: Size): void {
  const at = (cursor.value ??= { x_m: view.x_m, y_m: view.y_m });
  if (held.value) {
    held.value = null;
    drop();
    return;
  }
  const place = position(at);
  const press = { view, size, point: toPixel(view, size, at.x_m, at.y_m), within: NEAR_PX };
  const own = state.selectedArea.value;
  const index = areaAt(state.areas.value, place, press);
  const part = own && (cornerAt(own.geometry, press) ?? (index !== null && index === state.selected.value ? "all" : null));
  if (!part) {
    select(index);
    return;
  }
  held.value = { part, from: place };
  announce(part === "all" ? "The area is held: arrow keys move it." : "The corner is held: arrow keys move it.");
}

function enterDraws(view: View, size: Size): void {
  const corners = state.corners.value;
  const at = cursor.value;
  if (!at && corners.length > 0) {
    finish();
    return;
  }
  const place = at ?? (cursor.value = { x_m: view.x_m, y_m: view.y_m });
  const here = toPixel(view, size, place.x_m, place.y_m);
  const isAt = (corner: Position | undefined) => {
    if (!corner) return false;
    const { x, y } = toPixel(view, size, ...corner);
    return Math.hypot(x - here.x, y - here.y) < 5;
  };
  if (isAt(corners.at(-1)) || (state.mode.value === "polygon" && corners.length > 2 && isAt(corners[0]))) finish();
  else addCorner(position(place));
}

/** Acts on a key of the map. Returns whether it was one of the areas'. */
export function pressArea(event: KeyboardEvent, view: View, size: Size): boolean {
  const isDrawing = state.mode.value !== "select";
  const acts: Record<string, () => void> = {
    Enter: () => (isDrawing ? enterDraws : enterSelects)(view, size),
    Escape: () => {
      held.value = null;
      giveUp();
    },
    Backspace: isDrawing ? takeCornerBack : removeSelected,
    Delete: removeSelected,
  };
  const act = acts[event.key];
  act?.();
  return act !== undefined;
}

/** Undo and redo, wherever on the page the focus is but in a field of text. */
export function pressHistory(event: KeyboardEvent): void {
  const isText = event.target instanceof HTMLInputElement && event.target.type === "text";
  if (isText || !(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase();
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  if (key === "y" || event.shiftKey) redo();
  else if (state.corners.value.length > 0) takeCornerBack();
  else undo();
}
