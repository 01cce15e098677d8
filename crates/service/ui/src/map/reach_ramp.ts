/** Colours of contours of energy, from the first to the last. */

const channels = (hex: string) => [1, 3, 5].map((at) => Number.parseInt(hex.trim().slice(at, at + 2), 16));

/** The colour of one of so many contours, between those of the style sheet. */
export function between(color: (name: string) => string, index: number, count: number): string {
  const share = count > 1 ? index / (count - 1) : 0;
  const [near, far] = [channels(color("reach")), channels(color("reach-far"))];
  return `rgb(${near.map((value, i) => Math.round(value + share * (far[i]! - value))).join(" ")})`;
}
