/** How areas look, from above and on the ground of the 3-D view: each kind has a colour and a pattern of its own. */
import type { Area, Geometry, Position } from "../api/areas";
import type { Place } from "../api/plans";
import type { Scene } from "../map/draw";
import { toPixel } from "../map/view";
import { KIND, kindOf, type Kind } from "./effects";
import { chainsOf, isPolygon, middleOf } from "./shape";
import type { Draft, ShownAreas } from "./shown";

/** From the middle of an area down to its arrow [CSS pixels]. */
const ARROW_BELOW_PX = 18;

/** Width and height of a tile of a pattern [CSS pixels]. */
const TILE_PX = 14;

/** The lines of each kind's tile, by shares of its width from its upper left. */
export const PATTERN: Record<Kind, [number, number, number, number][]> = {
  keep_out: [
    [0, 0, 1, 1],
    [0, 1, 1, 0],
  ],
  surface: [[0, 0.5, 1, 0.5]],
  max_speed_mps: [
    [0.2, 0.25, 0.4, 0.25],
    [0.7, 0.75, 0.9, 0.75],
  ],
  cost_factor: [[0, 1, 1, 0]],
  one_way_rad: [
    [0.35, 0.25, 0.65, 0.5],
    [0.65, 0.5, 0.35, 0.75],
  ],
};

const LINE_DASH: Record<Kind, number[]> = {
  keep_out: [],
  surface: [10, 5],
  max_speed_mps: [4, 4],
  cost_factor: [8, 4, 2, 4],
  one_way_rad: [16, 4],
};

/** A tile of a kind's lines, as fine as its canvas; arrows of a one way turn into its direction. */
function pattern({ context, color }: Scene, kind: Kind, direction_rad: number): CanvasPattern | null {
  const ratio = context.getTransform().a;
  const tile = document.createElement("canvas");
  tile.width = tile.height = Math.round(TILE_PX * ratio);
  const pen = tile.getContext("2d");
  if (!pen) return null;
  pen.strokeStyle = color(KIND[kind].color);
  pen.lineWidth = 1.4 * ratio;
  for (const [ax, ay, bx, by] of PATTERN[kind]) {
    pen.beginPath();
    pen.moveTo(ax * tile.width, ay * tile.width);
    pen.lineTo(bx * tile.width, by * tile.width);
    pen.stroke();
  }
  const filled = context.createPattern(tile, "repeat");
  filled?.setTransform(new DOMMatrix().rotate((-direction_rad * 180) / Math.PI).scale(TILE_PX / tile.width));
  return filled;
}

function trace({ context, view, size }: Scene, geometry: Geometry): void {
  context.beginPath();
  for (const chain of chainsOf(geometry)) {
    for (const [i, [x_m, y_m]] of chain.entries()) {
      const { x, y } = toPixel(view, size, x_m, y_m);
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    }
  }
}

function drawArea(scene: Scene, { properties, geometry }: Area, isSelected: boolean): void {
  const { context, color } = scene;
  const kind = kindOf(properties);
  const own = color(KIND[kind].color);
  context.save();
  trace(scene, geometry);
  if (isPolygon(geometry)) {
    context.globalAlpha = 0.14;
    context.fillStyle = own;
    context.fill("evenodd");
    context.globalAlpha = 0.75;
    const tiles = pattern(scene, kind, kind === "one_way_rad" ? Number(properties.one_way_rad) : 0);
    if (tiles) context.fillStyle = tiles;
    context.fill("evenodd");
    context.globalAlpha = 1;
  }
  const width = (isPolygon(geometry) ? 1.5 : 4) + (isSelected ? 1.5 : 0);
  stroke(scene, own, width, isPolygon(geometry) ? [] : LINE_DASH[kind]);
  context.restore();
}

/** Draws what is traced with a rim. Dashes end straight: round ends would close the gaps. */
function stroke({ context, color }: Scene, own: string, width: number, dash: number[]): void {
  context.lineJoin = "round";
  context.lineCap = "butt";
  context.strokeStyle = color("casing");
  context.lineWidth = width + 2;
  context.stroke();
  context.setLineDash(dash);
  context.strokeStyle = own;
  context.lineWidth = width;
  context.stroke();
}

/** An arrow along the only way, below what is written on the area. */
function drawArrow({ context, view, size, color }: Scene, { properties, geometry }: Area): void {
  if (typeof properties.one_way_rad !== "number") return;
  const { x, y } = toPixel(view, size, ...middleOf(geometry));
  context.save();
  context.translate(x, y + ARROW_BELOW_PX);
  context.rotate(-properties.one_way_rad);
  for (const [width, name] of [
    [6, "casing"],
    [2.5, KIND.one_way_rad.color],
  ] as const) {
    context.beginPath();
    context.moveTo(-16, 0);
    context.lineTo(16, 0);
    context.moveTo(9, -6);
    context.lineTo(16, 0);
    context.lineTo(9, 6);
    context.lineWidth = width;
    context.lineCap = context.lineJoin = "round";
    context.strokeStyle = color(name);
    context.stroke();
  }
  context.restore();
}

function drawCorners({ context, view, size, color }: Scene, corners: Position[], isRound: boolean): void {
  for (const [x_m, y_m] of corners) {
    const { x, y } = toPixel(view, size, x_m, y_m);
    context.beginPath();
    if (isRound) context.arc(x, y, 5, 0, 2 * Math.PI);
    else context.rect(x - 4.5, y - 4.5, 9, 9);
    context.fillStyle = color("casing");
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = color("end-ink");
    context.stroke();
  }
}

/** All areas; the selected one shows its corners. */
export function drawAreas(scene: Scene, { areas, selected }: ShownAreas): void {
  for (const [i, area] of areas.entries()) drawArea(scene, area, i === selected);
  for (const area of areas) drawArrow(scene, area);
  const own = selected === null ? undefined : areas[selected];
  if (own) drawCorners(scene, chainsOf(own.geometry).flat(), false);
}

/** The shape that is being drawn, with the edge to the pointer or cursor. */
export function drawDraft(scene: Scene, { corners, kind }: Draft, tip: Place | null): void {
  const { context, color } = scene;
  const ends: Position[] = tip ? [...corners, [tip.x_m, tip.y_m]] : corners;
  context.save();
  trace(scene, { type: "LineString", coordinates: ends });
  stroke(scene, color(KIND[kind].color), 2.5, [6, 4]);
  context.restore();
  drawCorners(scene, corners, true);
}
