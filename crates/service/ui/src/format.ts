/** Numbers as people read them. Quantities come in SI. */

const MINUS = "\u2212";
const THIN = "\u202f";

function digits(value: number, places: number): string {
  const text = Math.abs(value).toFixed(places);
  return value < 0 && Number(text) !== 0 ? MINUS + text : text;
}

/** Three significant digits or so, without an exponent. */
export function plain(value: number): string {
  if (value === 0 || !Number.isFinite(value)) return Number.isFinite(value) ? "0" : "–";
  const places = Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(Math.abs(value)))));
  return digits(value, places);
}

export const metres = (value_m: number) =>
  Math.abs(value_m) >= 10_000 ? `${digits(value_m / 1000, 1)}${THIN}km` : `${digits(value_m, Math.abs(value_m) < 100 ? 1 : 0)}${THIN}m`;

export interface EnergyUnit {
  name: string;
  joules: number;
}

/** The unit in which an energy is short to write. */
export function energyUnit(value_j: number): EnergyUnit {
  if (Math.abs(value_j) >= 1e6) return { name: "MJ", joules: 1e6 };
  return Math.abs(value_j) >= 1000 ? { name: "kJ", joules: 1000 } : { name: "J", joules: 1 };
}

export function energy(value_j: number): string {
  const { name, joules } = energyUnit(value_j);
  return `${digits(value_j / joules, name === "J" ? 0 : name === "kJ" ? 1 : 2)}${THIN}${name}`;
}

export const power = (value_w: number) => `${digits(value_w, Math.abs(value_w) < 100 ? 1 : 0)}${THIN}W`;
export const percent = (share: number, places = 0) => `${digits(100 * share, places)}${THIN}%`;
export const degrees = (value_rad: number, places = 1) => `${digits((value_rad * 180) / Math.PI, places)}°`;

/** Minutes and seconds. */
export function clock(value_s: number): string {
  const whole = Math.round(value_s);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

export const duration = (value_s: number) => `${clock(value_s)}${THIN}min`;

export function bytes(count: number): string {
  if (count < 1e3) return `${count}${THIN}B`;
  return count < 1e6 ? `${digits(count / 1e3, 0)}${THIN}kB` : `${digits(count / 1e6, 1)}${THIN}MB`;
}

/** `motor_heating` as words. */
export const words = (name: string) => name.replaceAll("_", " ");

/** `left_n` with its unit N as words, without the unit that stands beside it; `k1_w_per_n2` is k1. */
export const quantity = (name: string, unit: string) =>
  words(unit === "1" ? name : name.replace(/(_[a-z]{1,2})?_per_[a-z0-9]+$|_[a-z0-9]+$/, ""));

/** The service writes details without a capital and a stop; names of fields keep their letters. */
export const sentence = (text: string) =>
  (/^[a-z]+[\s.,;:]/.test(text) ? text.charAt(0).toUpperCase() + text.slice(1) : text) + (/[.!?]$/.test(text) ? "" : ".");
