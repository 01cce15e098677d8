/** The picture of the ground: a colour for each cell, shaded by a lamp in the north-west. */
import type { Cells } from "../api/maps";
import type { Layer } from "../plan/state";
import { at, ELEVATION, OBSTACLE, SLOPE, SURFACES, UNKNOWN, type Rgb } from "./ramp";

/** What a layer's colours stand for. */
export interface Scale {
  least: number;
  greatest: number;
}

/** Slope at each cell, tangent of its angle, and its parts east and north; central differences. */
export interface Slopes {
  east: Float32Array;
  north: Float32Array;
}

export function slopesOf({ rows, columns, cell_size_m, z_m }: Cells): Slopes {
  const east = new Float32Array(rows * columns);
  const north = new Float32Array(rows * columns);
  for (let row = 0; row < rows; row++) {
    const below = Math.max(row - 1, 0);
    const above = Math.min(row + 1, rows - 1);
    for (let column = 0; column < columns; column++) {
      const left = Math.max(column - 1, 0);
      const right = Math.min(column + 1, columns - 1);
      const i = row * columns + column;
      east[i] = (z_m[row * columns + right]! - z_m[row * columns + left]!) / ((right - left || 1) * cell_size_m);
      north[i] = (z_m[above * columns + column]! - z_m[below * columns + column]!) / ((above - below || 1) * cell_size_m);
    }
  }
  return { east, north };
}

const slopeAt = ({ east, north }: Slopes, i: number) => Math.hypot(east[i]!, north[i]!);

/** The range that a layer's colours span; slopes in radians, up to what 99 % of the cells keep below. */
export function scaleOf(cells: Cells, slopes: Slopes, layer: Layer): Scale {
  if (layer === "slope") {
    const known: number[] = [];
    const step = Math.max(1, Math.floor(cells.z_m.length / 20_000));
    for (let i = 0; i < cells.z_m.length; i += step) {
      const slope = slopeAt(slopes, i);
      if (Number.isFinite(slope)) known.push(slope);
    }
    known.sort((a, b) => a - b);
    return { least: 0, greatest: Math.atan(Math.max(known[Math.floor(0.99 * known.length)] ?? 0, 0.02)) };
  }
  let [least, greatest] = [Infinity, -Infinity];
  for (const z of cells.z_m) {
    if (z < least) least = z;
    if (z > greatest) greatest = z;
  }
  return { least, greatest };
}

/** Heights are stretched until the ground has this much slope on average, so that gentle ground shows too. */
const SHOWN_SLOPE = 0.22;

function stretch(slopes: Slopes): number {
  let [sum, count] = [0, 0];
  const step = Math.max(1, Math.floor(slopes.east.length / 20_000));
  for (let i = 0; i < slopes.east.length; i += step) {
    const slope = slopeAt(slopes, i);
    if (!Number.isFinite(slope)) continue;
    sum += slope;
    count += 1;
  }
  return Math.min(Math.max(SHOWN_SLOPE / (sum / count || 1), 1), 8);
}

/** Draws a layer, one pixel a cell, north up. */
export function relief(cells: Cells, slopes: Slopes, layer: Layer, scale: Scale): HTMLCanvasElement {
  const { rows, columns } = cells;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [columns, rows];
  const context = canvas.getContext("2d");
  if (!context) return canvas;
  const image = context.createImageData(columns, rows);
  const span = scale.greatest - scale.least || 1;
  const exaggeration = stretch(slopes);
  const ramp = Array.from({ length: 256 }, (_, i) => at(layer === "slope" ? SLOPE : ELEVATION, i / 255));
  const tint = (i: number): Rgb => {
    if (cells.obstacle[i]) return OBSTACLE;
    if (Number.isNaN(cells.z_m[i])) return UNKNOWN;
    if (layer === "surface") return surfaceColor(cells.surface[i]!);
    const value = layer === "slope" ? Math.atan(slopeAt(slopes, i)) : cells.z_m[i]!;
    return ramp[Math.round(255 * Math.min(Math.max((value - scale.least) / span, 0), 1))] as Rgb;
  };
  for (let i = 0; i < rows * columns; i++) {
    const pixel = 4 * ((rows - 1 - Math.floor(i / columns)) * columns + (i % columns));
    const shade = layer === "slope" ? 1 : shadeAt(slopes, i, exaggeration);
    const rgb = tint(i);
    for (let k = 0; k < 3; k++) image.data[pixel + k] = Math.min(255, rgb[k]! * shade);
    image.data[pixel + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Brightness by Horn (1981), lamp at 45° in the north-west, 1 on level ground. */
function shadeAt({ east, north }: Slopes, i: number, exaggeration: number): number {
  const [p, q] = [east[i]! * exaggeration, north[i]! * exaggeration];
  const bright = (1 + (p - q) * Math.SQRT1_2) / Math.sqrt(1 + p * p + q * q);
  return Number.isNaN(bright) ? 1 : 0.45 + 0.55 * Math.max(0, bright);
}

/** Ground that the map leaves open is white. */
export const surfaceColor = (index: number): Rgb => (index === 255 ? [244, 242, 238] : (SURFACES[index % SURFACES.length] as Rgb));
