/** A chart over one axis (uPlot), which tells where it is pointed at and can be pointed at from outside. */
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { color, theme } from "../theme";

export interface Line {
  name: string;
  /** A colour of the style sheet. */
  color: string;
  width?: number;
  dash?: number[];
  fill?: boolean;
}

/** A stretch of the axis that is shaded. */
export interface Band {
  from: number;
  to: number;
}

interface Props {
  label: string;
  height: number;
  /** The axis, then the values of each line. */
  data: (number | null)[][];
  lines: Line[];
  axisUnit?: string;
  bands?: Band[];
  /** Where the chart is pointed at; null: nowhere. */
  at?: number | null;
  point?: (at: number) => void;
  hasAxis?: boolean;
}

/** A tick, with a minus as wide as a plus. */
const written = (tick: number) => String(tick).replace("-", "\u2212");

const FONT = "11px system-ui, sans-serif";

function options(
  { height, lines, bands = [], hasAxis = true, axisUnit }: Props,
  width: number,
  point: (at: number) => void,
): uPlot.Options {
  const [ink, grid] = [color("ink-soft"), color("line")];
  const axis = { stroke: ink, font: FONT, grid: { stroke: grid, width: 1 }, ticks: { show: false } };
  return {
    width,
    height,
    legend: { show: false },
    padding: [6, 20, hasAxis ? 0 : 4, 0],
    scales: { x: { time: false } },
    cursor: { y: false, drag: { x: false, y: false }, points: { size: 8 } },
    axes: [
      {
        ...axis,
        show: hasAxis,
        size: 24,
        gap: 2,
        values: (_, ticks) => ticks.map((tick, i) => written(tick) + (i === ticks.length - 1 && axisUnit ? ` ${axisUnit}` : "")),
      },
      { ...axis, size: 48, gap: 4, space: 22, values: (_, ticks) => ticks.map(written) },
    ],
    series: [
      {},
      ...lines.map((line): uPlot.Series => {
        const stroke = color(line.color);
        return {
          label: line.name,
          stroke,
          width: line.width ?? 1.5,
          spanGaps: true,
          points: { show: false },
          ...(line.dash && { dash: line.dash }),
          ...(line.fill && { fill: color(`${line.color}-soft`) }),
        };
      }),
    ],
    hooks: {
      drawClear: [(plot) => shade(plot, bands)],
      setCursor: [
        (plot) => {
          const left = plot.cursor.left ?? -1;
          if (left >= 0) point(plot.posToVal(left, "x"));
        },
      ],
    },
  };
}

function shade(plot: uPlot, bands: Band[]): void {
  plot.ctx.fillStyle = color("band");
  for (const { from, to } of bands) {
    const [left, right] = [plot.valToPos(from, "x", true), plot.valToPos(to, "x", true)];
    const [a, b] = [Math.max(left, plot.bbox.left), Math.min(right, plot.bbox.left + plot.bbox.width)];
    if (b > a) plot.ctx.fillRect(a, plot.bbox.top, b - a, plot.bbox.height);
  }
}

export function Chart(props: Props) {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const pointed = useRef(props.point);
  pointed.current = props.point;
  const look = JSON.stringify([theme.value, props.height, props.lines, props.bands, props.hasAxis]);

  useEffect(() => {
    const element = place.current;
    if (!element) return;
    const made = new uPlot(
      options(props, element.clientWidth || 300, (at) => pointed.current?.(at)),
      props.data as uPlot.AlignedData,
      element,
    );
    plot.current = made;
    const watcher = new ResizeObserver(() => {
      if (element.clientWidth > 0) made.setSize({ width: element.clientWidth, height: props.height });
    });
    watcher.observe(element);
    return () => {
      watcher.disconnect();
      made.destroy();
      plot.current = null;
    };
  }, [look]);

  useEffect(() => plot.current?.setData(props.data as uPlot.AlignedData), [props.data]);

  useEffect(() => {
    const made = plot.current;
    if (!made || props.at === undefined) return;
    const left = props.at === null ? -10 : made.valToPos(props.at, "x");
    // Without the hook: what was set from outside is not told back.
    made.setCursor({ left, top: 10 }, false);
  }, [props.at, props.data, look]);

  return <div class="chart" ref={place} role="img" aria-label={props.label} />;
}
