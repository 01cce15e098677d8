/** Which part of a map a canvas shows. Map metres go east and north, pixels right and down. */
import type { MapSummary } from "../api/maps";

export interface View {
  /** Map metres in the middle of the canvas. */
  x_m: number;
  y_m: number;
  /** CSS pixels for a metre. */
  px_per_m: number;
}

export interface Size {
  width: number;
  height: number;
}

export interface Point {
  x: number;
  y: number;
}

type Extent = Pick<MapSummary, "origin_m" | "columns" | "rows" | "cell_size_m">;

export const extentOf = ({ origin_m: [x, y], columns, rows, cell_size_m }: Extent) => ({
  west_m: x,
  south_m: y,
  width_m: columns * cell_size_m,
  height_m: rows * cell_size_m,
});

/** Frames narrower than this are phones' [px]: controls and readings have rows of their own, above and below the map. */
const PHONE_PX = 620;
/** Height of such a row with its margins [px]. */
const ROW_PX = 60;

/** The whole map, with a margin. */
export function fitted(map: Extent, size: Size): View {
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  const rows_px = size.width < PHONE_PX ? Math.min(2 * ROW_PX, size.height / 3) : 0;
  const px_per_m = Math.min((0.96 * size.width) / width_m, Math.min(0.96 * size.height, size.height - rows_px) / height_m);
  return { x_m: west_m + width_m / 2, y_m: south_m + height_m / 2, px_per_m };
}

export const toPixel = (view: View, size: Size, x_m: number, y_m: number): Point => ({
  x: size.width / 2 + (x_m - view.x_m) * view.px_per_m,
  y: size.height / 2 - (y_m - view.y_m) * view.px_per_m,
});

export const toMetres = (view: View, size: Size, { x, y }: Point) => ({
  x_m: view.x_m + (x - size.width / 2) / view.px_per_m,
  y_m: view.y_m - (y - size.height / 2) / view.px_per_m,
});

/** The view moved by pixels. */
export const panned = (view: View, dx: number, dy: number): View => ({
  ...view,
  x_m: view.x_m - dx / view.px_per_m,
  y_m: view.y_m + dy / view.px_per_m,
});

/** The view zoomed about a point, between half the map and single cells. */
export function zoomed(view: View, size: Size, about: Point, factor: number, map: Extent): View {
  const least = fitted(map, size).px_per_m / 2;
  const px_per_m = Math.min(Math.max(view.px_per_m * factor, least), 60 / map.cell_size_m);
  const fixed = toMetres(view, size, about);
  const moved = toMetres({ ...view, px_per_m }, size, about);
  return { px_per_m, x_m: view.x_m + fixed.x_m - moved.x_m, y_m: view.y_m + fixed.y_m - moved.y_m };
}

/** A round length, 1, 2 or 5 times a power of ten, that takes about so many pixels. */
export function roundLength_m(view: View, pixels: number): number {
  const rough = pixels / view.px_per_m;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([5, 2, 1].find((step) => step * power <= rough) ?? 1);
}
