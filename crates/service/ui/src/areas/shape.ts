/** Polygons and lines: where their middle is, where they are hit, and how they are moved. */
import type { Area, Geometry, Position } from "../api/areas";
import { toPixel, type Point, type Size, type View } from "../map/view";

/** Rings of polygons, which are closed, and lines. */
export function chainsOf(geometry: Geometry): Position[][] {
  if (geometry.type === "LineString") return [geometry.coordinates];
  return geometry.type === "MultiPolygon" ? geometry.coordinates.flat() : geometry.coordinates;
}

export const isPolygon = ({ type }: Geometry) => type === "Polygon" || type === "MultiPolygon";

/** The middle of what a polygon spans, or the middle one of a line's corners [m]. */
export function middleOf(geometry: Geometry): Position {
  const points = chainsOf(geometry).flat();
  const of = (axis: 0 | 1) => {
    const [least, most] = points.reduce(([low, high], at) => [Math.min(low, at[axis]), Math.max(high, at[axis])], [Infinity, -Infinity]);
    return (least + most) / 2;
  };
  return isPolygon(geometry) ? [of(0), of(1)] : (points[Math.floor((points.length - 1) / 2)] ?? [of(0), of(1)]);
}

/** A shape of the same kind, each of whose positions is changed. */
function changed(geometry: Geometry, change: (position: Position, chain: number, at: number) => Position): Geometry {
  let chains = 0;
  const chain = (positions: Position[]) => {
    const number = chains++;
    return positions.map((position, at) => change(position, number, at));
  };
  if (geometry.type === "LineString") return { type: geometry.type, coordinates: chain(geometry.coordinates) };
  if (geometry.type === "MultiPolygon") {
    return { type: geometry.type, coordinates: geometry.coordinates.map((rings) => rings.map(chain)) };
  }
  return { type: geometry.type, coordinates: geometry.coordinates.map(chain) };
}

/** To the millimetre. */
const rounded = (value_m: number) => Number(value_m.toFixed(3));
export const position = ({ x_m, y_m }: { x_m: number; y_m: number }): Position => [rounded(x_m), rounded(y_m)];

/** The part of a shape that is dragged: all of it, or one corner. */
export type Part = "all" | { chain: number; at: number };

/** A shape of which a part is dragged from one place to another. */
export function dragged(geometry: Geometry, part: Part, from: Position, to: Position): Geometry {
  const by = [to[0] - from[0], to[1] - from[1]] as const;
  const moved = ([x, y]: Position): Position => [rounded(x + by[0]), rounded(y + by[1])];
  if (part === "all") return changed(geometry, moved);
  const last = isPolygon(geometry) ? (chainsOf(geometry)[part.chain]?.length ?? 0) - 1 : NaN;
  // The first position of a ring is its last, too.
  const isPart = (at: number) => at === part.at || (part.at === 0 && at === last) || (part.at === last && at === 0);
  return changed(geometry, (each, chain, at) => (chain === part.chain && isPart(at) ? moved(each) : each));
}

/** Whether an odd number of rings encloses a place. */
function encloses(rings: Position[][], [x, y]: Position): boolean {
  let isInside = false;
  for (const ring of rings) {
    for (let i = 1; i < ring.length; i++) {
      const [[ax, ay], [bx, by]] = [ring[i - 1] as Position, ring[i] as Position];
      if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) isInside = !isInside;
    }
  }
  return isInside;
}

/** Pixels from a point to an edge. */
function pixelsToEdge(point: Point, a: Point, b: Point): number {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const along = ((point.x - a.x) * dx + (point.y - a.y) * dy) / (dx * dx + dy * dy || 1);
  const share = Math.min(Math.max(along, 0), 1);
  return Math.hypot(a.x + share * dx - point.x, a.y + share * dy - point.y);
}

/** What of the map is pressed, and how near counts. */
export interface Press {
  view: View;
  size: Size;
  point: Point;
  /** Pixels. */
  within: number;
}

/** The corner of a shape that is pressed. */
export function cornerAt(geometry: Geometry, { view, size, point, within }: Press): Part | null {
  for (const [chain, positions] of chainsOf(geometry).entries()) {
    const at = positions.findIndex(([x_m, y_m]) => {
      const corner = toPixel(view, size, x_m, y_m);
      return Math.hypot(corner.x - point.x, corner.y - point.y) <= within;
    });
    if (at >= 0) return { chain, at };
  }
  return null;
}

/** The index of the topmost area that is pressed; null where there is none. */
export function areaAt(areas: Area[], place: Position, { view, size, point, within }: Press): number | null {
  const isHit = ({ geometry }: Area) => {
    const chains = chainsOf(geometry);
    if (isPolygon(geometry) && encloses(chains, place)) return true;
    const edges = chains.map((chain) => chain.map(([x_m, y_m]) => toPixel(view, size, x_m, y_m)));
    return edges.some((chain) => chain.some((b, i) => i > 0 && pixelsToEdge(point, chain[i - 1] as Point, b) <= within));
  };
  const index = areas.findLastIndex(isHit);
  return index < 0 ? null : index;
}
