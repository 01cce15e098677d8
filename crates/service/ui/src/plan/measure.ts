/** Measuring on the map: points one after the other, with length and climb over the ground between them. */
import { computed, signal } from "@preact/signals";
import type { Cells } from "../api/maps";
import { metres } from "../format";
import * as state from "./state";

type Point = [number, number];

export const points = signal<Point[]>([]);

export interface Measured {
  length_m: number;
  /** Sums of all rises and falls along the line; NaN where it leaves known ground. */
  up_m: number;
  down_m: number;
}

function elevationAt({ x_m, y_m, cell_size_m, columns, rows, z_m }: Cells, [x, y]: Point): number {
  const [column, row] = [Math.floor((x - x_m) / cell_size_m), Math.floor((y - y_m) / cell_size_m)];
  return column < 0 || row < 0 || column >= columns || row >= rows ? NaN : z_m[row * columns + column]!;
}

/** Length on the map, and climb and descent by the cells below, looked at once for each cell of the way. */
export function measure(line: Point[], cells: Cells): Measured {
  const sum: Measured = { length_m: 0, up_m: 0, down_m: 0 };
  for (const [i, to] of line.entries()) {
    const from = line[i - 1];
    if (!from) continue;
    const length_m = Math.hypot(to[0] - from[0], to[1] - from[1]);
    sum.length_m += length_m;
    const steps = Math.max(1, Math.ceil(length_m / cells.cell_size_m));
    let before = elevationAt(cells, from);
    for (let step = 1; step <= steps; step++) {
      const part = step / steps;
      const now = elevationAt(cells, [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])]);
      const rise_m = now - before;
      if (Number.isNaN(rise_m)) [sum.up_m, sum.down_m] = [NaN, NaN];
      else if (rise_m > 0) sum.up_m += rise_m;
      else sum.down_m -= rise_m;
      before = now;
    }
  }
  return sum;
}

/** What is measured, in words. */
export const measured = computed(() => {
  const cells = state.cells.value;
  if (points.value.length < 2 || !cells) return "Click two or more points; Escape begins anew";
  const { length_m, up_m, down_m } = measure(points.value, cells);
  const climb = Number.isNaN(up_m) ? "over unknown ground" : `${metres(up_m)} up, ${metres(down_m)} down`;
  return `${metres(length_m)}, ${climb}`;
});
