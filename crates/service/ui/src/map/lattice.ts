/** Numbers between the nodes of a lattice, and the way back. */
import type { Lattice } from "../api/earth";

type Pair = [number, number];

/** The pair at a place of the rectangle, by parts of its width and height; bilinear, and straight on beyond the rectangle. */
export function between({ columns, rows, nodes }: Lattice, [right, along]: Pair): Pair {
  const [u, v] = [right * (columns - 1), along * (rows - 1)];
  const column = Math.min(Math.max(Math.floor(u), 0), columns - 2);
  const row = Math.min(Math.max(Math.floor(v), 0), rows - 2);
  const [s, t] = [u - column, v - row];
  const at = (c: number, r: number) => nodes[(row + r) * columns + column + c]!;
  const value = (axis: 0 | 1) =>
    (at(0, 0)[axis] * (1 - s) + at(1, 0)[axis] * s) * (1 - t) + (at(0, 1)[axis] * (1 - s) + at(1, 1)[axis] * s) * t;
  return [value(0), value(1)];
}

/** Steps of Newton's method; the lattice is so nearly even that three do. */
const STEPS = 8;

/** The place of the rectangle where the lattice has a pair, by parts of its width and height. */
export function partsOf(lattice: Lattice, wanted: Pair): Pair {
  const STEP = 1e-4;
  let parts: Pair = [0.5, 0.5];
  for (let i = 0; i < STEPS; i++) {
    const here = between(lattice, parts);
    const right = between(lattice, [parts[0] + STEP, parts[1]]);
    const along = between(lattice, [parts[0], parts[1] + STEP]);
    const [a, b] = [(right[0] - here[0]) / STEP, (along[0] - here[0]) / STEP];
    const [c, d] = [(right[1] - here[1]) / STEP, (along[1] - here[1]) / STEP];
    const [x, y] = [wanted[0] - here[0], wanted[1] - here[1]];
    const determinant = a * d - b * c;
    parts = [parts[0] + (d * x - b * y) / determinant, parts[1] + (a * y - c * x) / determinant];
  }
  return parts;
}
