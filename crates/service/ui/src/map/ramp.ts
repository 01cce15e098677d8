/** Colours for quantities; each ramp rises steadily in lightness or falls, so that it reads without hue. */

export type Rgb = [number, number, number];

/** Ground from low to high: quiet, so that paths stand out. */
export const ELEVATION: Rgb[] = [
  [118, 145, 140],
  [151, 171, 150],
  [190, 197, 164],
  [219, 211, 178],
  [236, 225, 202],
  [248, 243, 232],
];

/** Ground from level to steep. */
export const SLOPE: Rgb[] = [
  [246, 241, 230],
  [245, 214, 160],
  [231, 160, 97],
  [191, 97, 62],
  [124, 45, 52],
];

/** Surfaces: colours of Okabe and Ito, thinned. */
export const SURFACES: Rgb[] = [
  [232, 205, 150],
  [176, 196, 214],
  [178, 208, 186],
  [222, 184, 202],
  [214, 214, 170],
  [196, 186, 220],
];

export const UNKNOWN: Rgb = [128, 128, 132];
export const OBSTACLE: Rgb = [70, 66, 72];

/** The colour at a share of a ramp, 0 to 1. */
export function at(ramp: Rgb[], share: number): Rgb {
  const place = Math.min(Math.max(share, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(place), ramp.length - 2);
  const [a, b, t] = [ramp[low] as Rgb, ramp[low + 1] as Rgb, place - low];
  return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])];
}

/** The ramp as a CSS gradient, left to right. */
export const gradient = (ramp: Rgb[]) => `linear-gradient(to right, ${ramp.map((rgb) => `rgb(${rgb.join(" ")})`).join(", ")})`;
