/** Which way north is. */
import { northOf } from "./north";
import { earth } from "./earth";

export function NorthArrow() {
  const { turn_deg, title } = northOf(earth.value?.true_north_rad ?? null);
  return (
    <svg class="north-arrow" viewBox="-12 -20 24 40" width="26" height="44" role="img" aria-label={title}>
      <title>{title}</title>
      <g transform={`rotate(${turn_deg.toFixed(2)})`}>
        <path d="M0 -10 6 9 0 5 -6 9Z" class="north-needle" />
        <text y="-12" text-anchor="middle">
          N
        </text>
      </g>
    </svg>
  );
}
