/** Mouse and touch on the map: place ends, drag them, turn them, pan, zoom, and point at paths. */
import { moved, pressed, released, type AreaPress } from "../areas/gestures";
import { preview } from "../areas/state";
import { points } from "../plan/measure";
import { followedPaths } from "../plan/shown_paths";
import * as state from "../plan/state";
import { nearest } from "./along";
import { handleAt } from "./draw";
import { setEnd, settle, type End } from "./ends";
import { pointer } from "./pointed";
import { addStop, moveStop } from "./stops";
import { panned, toMetres, toPixel, zoomed, type Point, type Size, type View } from "./view";

/** What a gesture works on. */
export interface Board {
  element: HTMLElement;
  size: () => Size;
  view: () => View | null;
  show: (view: View) => void;
}

type Doing =
  | { kind: "pan" }
  | { kind: "move"; end: End }
  | { kind: "turn"; end: End; isPlacing: boolean }
  | { kind: "pinch"; apart: number }
  | { kind: "stop"; index: number }
  | { kind: "new-stop"; from: Point }
  | { kind: "point"; from: Point }
  | AreaPress;

/** Pixels within which something is hit; fingers are wider than pointers. */
const reach = (event: PointerEvent) => (event.pointerType === "touch" ? 26 : 15);
/** A pointer that goes further than this is dragging. */
const DRAG_PX = 8;

/** Listens until the signal ends. */
export function listen(board: Board, signal: AbortSignal): void {
  const { element } = board;
  const fingers = new Map<number, Point>();
  let doing: Doing | null = null;
  let last: Point = { x: 0, y: 0 };

  const pointOf = (event: MouseEvent): Point => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const on = <K extends keyof HTMLElementEventMap>(name: K, act: (event: HTMLElementEventMap[K]) => void) =>
    element.addEventListener(name, act, { signal, passive: false });

  on("pointerdown", (event) => {
    const view = board.view();
    if (!view || event.button > 1) return;
    element.setPointerCapture(event.pointerId);
    last = pointOf(event);
    fingers.set(event.pointerId, last);
    if (fingers.size === 2) preview.value = null;
    doing = fingers.size === 2 ? { kind: "pinch", apart: apart(fingers) } : begun(board, view, event, last);
    if (doing.kind === "move" || doing.kind === "stop") state.isDragging.value = true;
  });

  on("pointermove", (event) => {
    const view = board.view();
    const size = board.size();
    const point = pointOf(event);
    pointer.value = point;
    if (!view) return;
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, point);
    if (!doing) pointAt(view, size, point, reach(event));
    else if (doing.kind === "pinch") doing.apart = pinch(board, view, fingers, doing.apart);
    else if (doing.kind === "corner" || doing.kind === "drag") doing = moved(doing, point) ? { kind: "pan" } : doing;
    else if (doing.kind === "stop") moveStop(doing.index, toMetres(view, size, point));
    else if (doing.kind === "new-stop" || doing.kind === "point") doing = isFar(doing.from, point) ? { kind: "pan" } : doing;
    else if (doing.kind === "pan") board.show(panned(view, point.x - last.x, point.y - last.y));
    else drag(view, size, point, doing);
    last = point;
  });

  const end = (event: PointerEvent) => {
    fingers.delete(event.pointerId);
    if (doing?.kind === "move" || doing?.kind === "turn") settle(doing.end);
    if (doing?.kind === "corner" || doing?.kind === "drag") endArea(event, doing);
    const view = board.view();
    if ((doing?.kind === "new-stop" || doing?.kind === "point") && view && event.type === "pointerup") {
      const place = toMetres(view, board.size(), doing.from);
      if (doing.kind === "point") points.value = [...points.value, [place.x_m, place.y_m]];
      else addStop(place);
    }
    doing = null;
    state.isDragging.value = false;
  };
  // The map may come under a pointer that rests.
  on("pointerenter", (event) => (pointer.value = pointOf(event)));
  on("pointerleave", () => (pointer.value = null));
  on("pointerup", end);
  on("pointercancel", end);

  on("wheel", (event) => {
    const [view, map] = [board.view(), state.map.value];
    if (!view || !map) return;
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    board.show(zoomed(view, board.size(), pointOf(event), Math.exp(-0.0016 * lines * event.deltaY), map));
  });
}

const isFar = (from: Point, to: Point) => Math.hypot(to.x - from.x, to.y - from.y) > DRAG_PX;

/** A press that the browser takes away changes nothing. */
function endArea(event: PointerEvent, doing: AreaPress): void {
  if (event.type === "pointerup") released(doing);
  else preview.value = null;
}

/** What a press begins: a heading's handle, an end, a placing, or a pan. */
function begun(board: Board, view: View, event: PointerEvent, point: Point): Doing {
  const size = board.size();
  const near = (at: Point) => Math.hypot(at.x - point.x, at.y - point.y) <= reach(event);
  const placing = state.tool.value;
  if (placing === "areas") {
    const press = { view, size, point, within: reach(event) };
    return (event.button === 0 && pressed(press)) || { kind: "pan" };
  }
  if (placing === "measure" && event.button === 0) return { kind: "point", from: point };
  const isMission = state.journey.value === "stops";
  for (const end of isMission ? (["start"] as const) : (["start", "goal"] as const)) {
    const place = state[end].value;
    if (!place) continue;
    if (place.heading_rad !== undefined && near(handleAt(view, size, place))) return { kind: "turn", end, isPlacing: false };
    if (
      near(toPixel(view, size, place.x_m, place.y_m)) &&
      (placing !== "start" || end === "start") &&
      (placing !== "goal" || end === "goal")
    )
      return { kind: "move", end };
  }
  const stop = isMission ? state.stops.value.findIndex(({ x_m, y_m }) => near(toPixel(view, size, x_m, y_m))) : -1;
  if (stop >= 0 && placing !== "start") return { kind: "stop", index: stop };
  if (placing === "move" || event.button === 1) return { kind: "pan" };
  if (placing === "measure") return { kind: "pan" };
  if (placing === "stops") return { kind: "new-stop", from: point };
  setEnd(placing, toMetres(view, size, point));
  return { kind: "turn", end: placing, isPlacing: true };
}

function drag(view: View, size: Size, point: Point, doing: Extract<Doing, { end: End }>): void {
  const place = state[doing.end].value;
  if (!place) return;
  if (doing.kind === "move") {
    setEnd(doing.end, { ...place, ...toMetres(view, size, point) });
    return;
  }
  const from = toPixel(view, size, place.x_m, place.y_m);
  if (doing.isPlacing && Math.hypot(point.x - from.x, point.y - from.y) < DRAG_PX) return;
  state[doing.end].value = { ...place, heading_rad: Math.atan2(from.y - point.y, point.x - from.x) };
}

const apart = (fingers: Map<number, Point>) => {
  const [a, b] = [...fingers.values()];
  return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 1;
};

function pinch(board: Board, view: View, fingers: Map<number, Point>, before: number): number {
  const [a, b] = [...fingers.values()];
  const map = state.map.value;
  if (!a || !b || !map) return before;
  const now = apart(fingers);
  board.show(zoomed(view, board.size(), { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 }, now / before, map));
  return now;
}

/** Puts the robot on the path that the pointer is at, and that path in focus. */
function pointAt(view: View, size: Size, point: Point, within: number): void {
  for (const { poses, objective } of [...followedPaths.value].reverse()) {
    const found = nearest(poses, view, size, point);
    if (!found || found.off > within) continue;
    if (objective) state.focus.value = objective;
    state.along_m.value = found.pose.distance_m;
    return;
  }
}
