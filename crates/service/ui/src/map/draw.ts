/** What lies over the ground: contours, paths, ends and the robot. */
import type { Objective, Place, Pose } from "../api/plans";
import type { Contour } from "../api/reachable";
import { energy } from "../format";
import type { Backdrop, ShownPath } from "../plan/shown_paths";
import { between } from "./reach_ramp";
import { toPixel, type Size, type View } from "./view";

/** How each path is drawn; dashes tell them apart without colour. */
export const STYLE: Record<Objective | "former" | "mission" | "back", { color: string; dash: number[]; name: string }> = {
  energy: { color: "path-energy", dash: [], name: "Energy-minimal" },
  distance: { color: "path-distance", dash: [10, 9], name: "Shortest" },
  time: { color: "path-time", dash: [1, 7], name: "Fastest" },
  former: { color: "path-former", dash: [12, 4, 2, 4], name: "Before correction" },
  mission: { color: "path-energy", dash: [], name: "Mission" },
  back: { color: "fine", dash: [3, 8], name: "Way back" },
};

export interface Scene {
  context: CanvasRenderingContext2D;
  view: View;
  size: Size;
  /** A colour of the style sheet. */
  color: (name: string) => string;
}

function trace({ context, view, size }: Scene, points: Iterable<[number, number]>): void {
  let isFirst = true;
  for (const [x_m, y_m] of points) {
    const { x, y } = toPixel(view, size, x_m, y_m);
    if (isFirst) context.moveTo(x, y);
    else context.lineTo(x, y);
    isFirst = false;
  }
}

/** Contours of energy in the colours of their legend, each with how much it stands for at its northern end. */
export function drawContours(scene: Scene, contours: Contour[]): void {
  const { context, color, view, size } = scene;
  const colors = contours.map((_, i) => between(color, i, contours.length));
  for (const [i, { polygons }] of contours.entries()) {
    context.beginPath();
    for (const ring of polygons.flat()) {
      trace(scene, ring);
      context.closePath();
    }
    context.setLineDash([]);
    context.globalAlpha = 0.07;
    context.fillStyle = colors[i]!;
    context.fill("evenodd");
    context.globalAlpha = 1;
    context.strokeStyle = colors[i]!;
    context.lineWidth = 1.75;
    context.stroke();
  }
  context.font = "600 11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.strokeStyle = color("casing");
  for (const [i, { polygons, energy_j }] of contours.entries()) {
    context.fillStyle = colors[i]!;
    const top = polygons.flat(2).reduce<[number, number] | null>((best, point) => (best && best[1] >= point[1] ? best : point), null);
    if (!top) continue;
    const { x, y } = toPixel(view, size, ...top);
    context.strokeText(energy(energy_j), x, y);
    context.fillText(energy(energy_j), x, y);
  }
}

const FOCUS_PX = 4;
const OTHER_PX = 3;
/** A pale rim keeps every colour readable on every ground. */
const RIM_PX = 1.5;

type Drawn = Backdrop & { width: number };

function stroke(scene: Scene, { poses, width }: Drawn, color: string, dash: number[]): void {
  const { context } = scene;
  context.beginPath();
  trace(
    scene,
    poses.map((p) => [p.x_m, p.y_m]),
  );
  context.lineJoin = "round";
  context.lineCap = "round";
  context.setLineDash(dash);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
  context.setLineDash([]);
}

/** All paths, the one in focus on top; between the dashes of one, another that runs below it shows. */
export function drawPaths(scene: Scene, backdrops: Backdrop[], followed: ShownPath[]): void {
  const behind: Drawn[] = backdrops.map((path) => ({ ...path, width: OTHER_PX }));
  const all: Drawn[] = [...behind, ...followed.map((path, i) => ({ ...path, width: i === followed.length - 1 ? FOCUS_PX : OTHER_PX }))];
  for (const drawn of all) stroke(scene, { ...drawn, width: drawn.width + 2 * RIM_PX }, scene.color("casing"), []);
  for (const drawn of all) stroke(scene, drawn, scene.color(STYLE[drawn.style].color), STYLE[drawn.style].dash);
}

/** Length of the heading handle [px]. */
export const HANDLE_PX = 34;

/** Where the handle of a heading is. */
export function handleAt(view: View, size: Size, place: Place): { x: number; y: number } {
  const { x, y } = toPixel(view, size, place.x_m, place.y_m);
  const heading = place.heading_rad ?? 0;
  return { x: x + HANDLE_PX * Math.cos(heading), y: y - HANDLE_PX * Math.sin(heading) };
}

/** Start (a disc, with its heading if it has one); goal, numbered stop or turning point (a ringed disc), with its letter. */
export function drawEnd(scene: Scene, place: Place, letter: string): void {
  const { context, view, size, color } = scene;
  const { x, y } = toPixel(view, size, place.x_m, place.y_m);
  if (place.heading_rad !== undefined) {
    const tip = handleAt(view, size, place);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(tip.x, tip.y);
    context.strokeStyle = color("end-ink");
    context.lineWidth = 3;
    context.stroke();
    context.beginPath();
    context.arc(tip.x, tip.y, 5, 0, 2 * Math.PI);
    context.fillStyle = color("end-ink");
    context.fill();
  }
  context.beginPath();
  context.arc(x, y, 11, 0, 2 * Math.PI);
  context.fillStyle = letter === "S" ? color("end-ink") : color("casing");
  context.fill();
  context.lineWidth = 2.5;
  context.strokeStyle = letter === "S" ? color("casing") : color("end-ink");
  context.stroke();
  context.fillStyle = letter === "S" ? color("casing") : color("end-ink");
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(letter, x, y + 0.5);
}

/** The robot, nose along its heading. */
export function drawRobot({ context, view, size, color }: Scene, pose: Pose): void {
  const { x, y } = toPixel(view, size, pose.x_m, pose.y_m);
  context.save();
  context.translate(x, y);
  context.rotate(-pose.heading_rad);
  context.beginPath();
  context.roundRect(-11, -8, 22, 16, 4);
  context.fillStyle = color("robot");
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = color("robot-ink");
  context.stroke();
  context.beginPath();
  context.moveTo(1, -4);
  context.lineTo(7, 0);
  context.lineTo(1, 4);
  context.strokeStyle = color("robot-ink");
  context.lineJoin = "round";
  context.stroke();
  context.restore();
}

/** The keyboard's cursor. */
export function drawCrosshair({ context, view, size, color }: Scene, at: Place): void {
  const { x, y } = toPixel(view, size, at.x_m, at.y_m);
  for (const [width, name] of [
    [4, "casing"],
    [1.5, "end-ink"],
  ] as const) {
    context.beginPath();
    for (const [dx, dy] of [
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ] as const) {
      context.moveTo(x + 5 * dx, y + 5 * dy);
      context.lineTo(x + 16 * dx, y + 16 * dy);
    }
    context.strokeStyle = color(name);
    context.lineWidth = width;
    context.stroke();
  }
}
