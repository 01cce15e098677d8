/** The map by keyboard: arrows move a cursor, Enter places what is to be placed. */
import { announce } from "../announce";
import type { Place } from "../api/plans";
import { pressArea } from "../areas/keys";
import { isEditing } from "../areas/state";
import * as state from "../plan/state";
import { points } from "../plan/measure";
import { cursor } from "./cursor";
import { onMap, placeWords, setEnd, settle, turn } from "./ends";
import { pointer } from "./pointed";
import { addStop } from "./stops";
import { fitted, toPixel, zoomed, type Size, type View } from "./view";

const ARROWS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export const KEYS =
  "Arrow keys move the cursor, with Shift further. Enter places; S sets the start here, G the goal. Square brackets turn the start. Plus and minus zoom, 0 shows all.";

/** Acts on a key. Returns whether it was one of the map's. */
export function press(event: KeyboardEvent, view: View, size: Size, show: (view: View) => void): boolean {
  const map = state.map.value;
  if (!map || event.ctrlKey || event.metaKey || event.altKey) return false;
  const at = cursor.value ?? { x_m: view.x_m, y_m: view.y_m };
  const arrow = ARROWS[event.key];
  if (arrow) {
    move(at, arrow, event.shiftKey ? 60 : 10, view, size, show);
    return true;
  }
  if (isEditing.value && pressArea(event, view, size)) return true;
  const about = toPixel(view, size, at.x_m, at.y_m);
  const place = (end: "start" | "goal") => {
    setEnd(end, { ...at });
    settle(end);
  };
  const acts: Record<string, () => void> = {
    Escape: () => (points.value = []),
    Enter: () =>
      state.tool.value === "measure"
        ? (points.value = [...points.value, [at.x_m, at.y_m]])
        : state.tool.value === "stops"
          ? addStop({ ...at })
          : place(state.tool.value === "start" ? "start" : "goal"),
    s: () => place("start"),
    g: () => place("goal"),
    "[": () => turn("start", 1),
    "]": () => turn("start", -1),
    "+": () => show(zoomed(view, size, about, 1.4, map)),
    "=": () => show(zoomed(view, size, about, 1.4, map)),
    "-": () => show(zoomed(view, size, about, 1 / 1.4, map)),
    "0": () => show(fitted(map, size)),
  };
  const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  act?.();
  return act !== undefined;
}

function move(at: Place, [dx, dy]: [number, number], pixels: number, view: View, size: Size, show: (view: View) => void): void {
  const next = onMap({ x_m: at.x_m + (dx * pixels) / view.px_per_m, y_m: at.y_m + (dy * pixels) / view.px_per_m });
  cursor.value = next;
  pointer.value = null;
  announce(placeWords(next));
  const { x, y } = toPixel(view, size, next.x_m, next.y_m);
  const isInside = x > 30 && y > 30 && x < size.width - 30 && y < size.height - 30;
  if (!isInside) show({ ...view, x_m: next.x_m, y_m: next.y_m });
}
