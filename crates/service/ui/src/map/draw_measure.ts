/** The line that is measured, to where the pointer is. */
import type { Place } from "../api/plans";
import type { Scene } from "./draw";
import { toPixel } from "./view";

export function drawMeasure({ context, view, size, color }: Scene, points: [number, number][], next: Place | null): void {
  const pixels = points.map(([x_m, y_m]) => toPixel(view, size, x_m, y_m));
  const ahead = next && pixels.length > 0 ? toPixel(view, size, next.x_m, next.y_m) : null;
  for (const [width, name] of [
    [5, "casing"],
    [2, "end-ink"],
  ] as const) {
    context.beginPath();
    for (const [i, { x, y }] of pixels.entries()) i === 0 ? context.moveTo(x, y) : context.lineTo(x, y);
    context.strokeStyle = color(name);
    context.lineWidth = width;
    context.stroke();
    for (const { x, y } of pixels) {
      context.beginPath();
      context.arc(x, y, width + 1, 0, 2 * Math.PI);
      context.fillStyle = color(name);
      context.fill();
    }
  }
  const last = pixels.at(-1);
  if (!ahead || !last) return;
  context.beginPath();
  context.moveTo(last.x, last.y);
  context.lineTo(ahead.x, ahead.y);
  context.setLineDash([4, 4]);
  context.stroke();
  context.setLineDash([]);
}
