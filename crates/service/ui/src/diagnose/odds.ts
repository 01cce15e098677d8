/** Probabilities and odds as people read them. */
import { percent } from "../format";

const THIN = "\u202f";
/** Ratio beyond which the exact figure says nothing. */
const LARGEST = 1e6;

/** With one decimal, bounded where that would read 0 or 100. */
export function probability(p: number): string {
  if (p < 5e-4) return `<${THIN}0.1${THIN}%`;
  return p > 1 - 5e-4 ? `>${THIN}99.9${THIN}%` : percent(p, 1);
}

const grouped = (value: number) => value.toFixed(0).replace(/\B(?=(\d{3})+$)/g, THIN);
const side = (ratio: number) => (ratio < 10 ? ratio.toFixed(1) : grouped(ratio));

/** Odds of one probability against another, as `12 : 1` or `1 : 3.5`. */
export function odds(of: number, against: number): string {
  if (of >= against) return of / against <= LARGEST ? `${side(of / against)} : 1` : `> ${grouped(LARGEST)} : 1`;
  return against / of <= LARGEST ? `1 : ${side(against / of)}` : `< 1 : ${grouped(LARGEST)}`;
}
