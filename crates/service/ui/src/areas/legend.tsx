/** What the patterns of areas mean. */
import { PATTERN } from "./draw";
import { KIND, KINDS, kindsOf, type Kind } from "./effects";
import * as state from "./state";

export function AreasLegend() {
  const shown = new Set(state.areas.value.flatMap(({ properties }) => kindsOf(properties)));
  if (shown.size === 0) return null;
  return (
    <figure class="legend areas-legend">
      <figcaption>Areas</figcaption>
      <ul class="legend-list">
        {KINDS.filter((kind) => shown.has(kind)).map((kind) => (
          <li key={kind}>
            <AreaSwatch kind={kind} />
            {KIND[kind].name}
          </li>
        ))}
      </ul>
    </figure>
  );
}

/** Two tiles of a kind's pattern. */
function AreaSwatch({ kind }: { kind: Kind }) {
  const stroke = `var(--${KIND[kind].color})`;
  return (
    <svg viewBox="0 0 28 14" width="28" height="14" aria-hidden="true">
      <rect x="0.75" y="0.75" width="26.5" height="12.5" fill={stroke} fill-opacity="0.14" stroke={stroke} stroke-width="1.5" />
      {[0, 14].flatMap((left) =>
        PATTERN[kind].map(([ax, ay, bx, by]) => (
          <line
            key={`${left} ${ax} ${ay} ${by}`}
            x1={left + 14 * ax}
            y1={14 * ay}
            x2={left + 14 * bx}
            y2={14 * by}
            stroke={stroke}
            stroke-width="1.4"
          />
        )),
      )}
    </svg>
  );
}
