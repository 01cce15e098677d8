/** Where the robot drove, coloured by how much more it drew than its file predicts. */
import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { power } from "../format";
import { color, theme } from "../theme";
import { pointed } from "./pointed";
import type { Bounds, Difference, Trace } from "./report";
import { bandsOf } from "./time_axis";

const HEIGHT = 300;

interface Dot {
  index: number;
  x: number;
  y: number;
}

/** Places of the trace on the canvas. */
function dotsOf({ position_m }: Trace, width: number): Dot[] {
  const known = position_m.flatMap((at, index) => (at ? [{ index, x_m: at[0], y_m: at[1] }] : []));
  const [xs, ys] = [known.map((p) => p.x_m), known.map((p) => p.y_m)];
  const [west, east] = [Math.min(...xs), Math.max(...xs)];
  const [south, north] = [Math.min(...ys), Math.max(...ys)];
  const scale = Math.min((width - 32) / (east - west || 1), (HEIGHT - 32) / (north - south || 1));
  return known.map(({ index, x_m, y_m }) => ({
    index,
    x: width / 2 + (x_m - (west + east) / 2) * scale,
    y: HEIGHT / 2 - (y_m - (south + north) / 2) * scale,
  }));
}

const between = (value: number, [from, to]: Bounds) => value >= (from ?? -Infinity) && value < (to ?? Infinity);

/** Whether a position lies in one of the places that the report names. */
const isIn = (places: Difference[], [x_m, y_m]: [number, number]) =>
  places.some(({ range }) => range.x_m && range.y_m && between(x_m, range.x_m) && between(y_m, range.y_m));

function draw(canvas: HTMLCanvasElement, trace: Trace, where: Difference[], most_w: number): void {
  const ratio = devicePixelRatio || 1;
  const width = canvas.clientWidth;
  [canvas.width, canvas.height] = [width * ratio, HEIGHT * ratio];
  const context = canvas.getContext("2d");
  if (!context || width === 0) return;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const places = where.filter(({ kind }) => kind === "place");
  const [low, high, shade] = [color("error-low"), color("error-high"), color("band-strong")];
  const dots = dotsOf(trace, width);
  for (const { index, x, y } of dots) {
    const run = trace.run[index] ?? 0;
    const t_s = trace.t_s[index] ?? 0;
    const isNamed = bandsOf(where, trace, run).some(({ from, to }) => t_s >= from && t_s <= to) || isIn(places, trace.position_m[index]!);
    if (!isNamed) continue;
    context.fillStyle = shade;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.fill();
  }
  for (const { index, x, y } of dots) {
    const excess_w = (trace.recorded_w[index] ?? NaN) - (trace.filed_w[index] ?? NaN);
    if (Number.isNaN(excess_w)) continue;
    context.fillStyle = excess_w > 0 ? high : low;
    context.globalAlpha = 0.15 + 0.85 * Math.min(Math.abs(excess_w) / most_w, 1);
    context.beginPath();
    context.arc(x, y, 2.4, 0, 2 * Math.PI);
    context.fill();
  }
  context.globalAlpha = 1;
  const at = pointed.value;
  const dot = at && dots.find(({ index }) => trace.run[index] === at.run && (trace.t_s[index] ?? 0) >= at.t_s);
  if (!dot) return;
  context.beginPath();
  context.arc(dot.x, dot.y, 6, 0, 2 * Math.PI);
  context.strokeStyle = color("ink");
  context.lineWidth = 2.5;
  context.stroke();
}

/** The error that nine in ten stay below: beyond it colours are full. */
function fullAt(trace: Trace): number {
  const errors = trace.recorded_w.flatMap((recorded, i) =>
    recorded === null || trace.filed_w[i] == null ? [] : [Math.abs(recorded - trace.filed_w[i])],
  );
  errors.sort((a, b) => a - b);
  return errors[Math.floor(0.9 * errors.length)] || 1;
}

export function DriveMap({ trace, where }: { trace: Trace; where: Difference[] }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const most_w = fullAt(trace);
  useEffect(() => {
    const element = canvas.current;
    if (!element) return;
    const redraw = () => draw(element, trace, where, most_w);
    const watcher = new ResizeObserver(redraw);
    watcher.observe(element);
    const stop = effect(() => {
      void [theme.value, pointed.value];
      redraw();
    });
    return () => {
      watcher.disconnect();
      stop();
    };
  }, [trace]);
  const point = (event: MouseEvent) => {
    const element = event.currentTarget as HTMLElement;
    const box = element.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let best: { index: number; off: number } | null = null;
    for (const dot of dotsOf(trace, box.width)) {
      const off = Math.hypot(dot.x - x, dot.y - y);
      if (off < (best?.off ?? 16)) best = { index: dot.index, off };
    }
    if (best) pointed.value = { run: trace.run[best.index] ?? 0, t_s: trace.t_s[best.index] ?? 0 };
  };
  return (
    <section class="card drive-map" aria-label="Where the robot drove">
      <h3>On the ground</h3>
      <canvas
        ref={canvas}
        height={HEIGHT}
        role="img"
        aria-label="The drives from above, coloured by recorded less predicted power"
        onMouseMove={point}
      />
      <p class="key">
        <span>
          <i style={{ backgroundColor: "var(--error-high)" }} />
          drew more than its file predicts (full colour from {power(most_w)})
        </span>
        <span>
          <i style={{ backgroundColor: "var(--error-low)" }} />
          drew less
        </span>
        <span class="key-band">
          <i /> where they differ
        </span>
      </p>
    </section>
  );
}
