/** Places as people type them. */

/** A place in one of the ways in which it can be given. */
export interface Typed {
  /** Metres of the map, parts of its extent, degrees, or two plain numbers that may be metres or latitude and longitude. */
  kind: "numbers" | "parts" | "degrees";
  /** x and y, parts east and north, or longitude and latitude. */
  pair: [number, number];
  heading_deg?: number;
}

export const FORMS = "x, y in metres, @0.2,0.8 in parts of the map, or 46.5046N, 93.9217W; a heading in degrees may follow";

/** A text that is no place, with how to mend it. */
export class Unreadable extends Error {}

const NUMBER = String.raw`[-−+]?\d+(?:[.,]\d+)?|[-−+]?[.,]\d+`;
const LETTERED = new RegExp(`^(${NUMBER})\\s*([NSEW])\\s*[,;\\s]\\s*(${NUMBER})\\s*([NSEW])(?:\\s*[,;\\s]\\s*(${NUMBER}))?$`, "i");

function numberOf(text: string): number {
  if (!new RegExp(`^(?:${NUMBER})$`).test(text)) throw new Unreadable(`“${text}” is no number: give ${FORMS}`);
  return Number(text.replace(",", ".").replace("−", "-"));
}

/** The parts of a list of numbers, whichever of comma and point marks decimals. */
function split(text: string): string[] {
  const clean = (parts: string[]) => parts.map((part) => part.trim()).filter((part) => part !== "");
  if (text.includes(";")) return clean(text.split(";"));
  if (!/\s/.test(text)) {
    const parts = clean(text.split(","));
    if (parts.length > 3) throw new Unreadable(`“${text}” has ${parts.length} numbers: write 4.8, 5.2, or 4,8; 5,2 with decimal commas`);
    return parts;
  }
  const parts = clean(text.split(/,\s+|\s+/));
  const withCommas = parts.filter((part) => part.includes(","));
  // One comma alone may part two numbers or mark decimals.
  if (withCommas.length > 0 && !parts.slice(0, 2).every((part) => part.includes(",")))
    throw new Unreadable(`“${text}” can be read in two ways: write decimals with points, or part the numbers by semicolons`);
  return parts;
}

function headed(typed: Typed, heading: string | undefined): Typed {
  if (heading === undefined) return typed;
  const heading_deg = numberOf(heading);
  if (Math.abs(heading_deg) > 360) throw new Unreadable(`the heading is ${heading}, but must lie in −360 to 360 degrees`);
  return { ...typed, heading_deg };
}

/** Latitude and longitude, each with its letter, in either order. */
function lettered(text: string): Typed | null {
  const found = LETTERED.exec(text);
  if (!found) return null;
  const [, first = "", one = "", second = "", other = "", heading] = found;
  const letters = [one.toUpperCase(), other.toUpperCase()];
  const values = [numberOf(first), numberOf(second)];
  const along = (positive: string, negative: string, most: number) => {
    const at = letters.findIndex((letter) => letter === positive || letter === negative);
    const value = values[at];
    if (value === undefined) throw new Unreadable(`“${text}” needs one of N and S, and one of E and W`);
    if (value < 0 || value > most) throw new Unreadable(`${letters[at]} of “${text}” must lie in 0 to ${most} degrees`);
    return letters[at] === positive ? value : -value;
  };
  return headed({ kind: "degrees", pair: [along("E", "W", 180), along("N", "S", 90)] }, heading);
}

/** Reads a place; throws what is wrong with it. */
export function readTyped(text: string): Typed {
  const plain = text.replaceAll("°", "").trim();
  const degrees = lettered(plain);
  if (degrees) return degrees;
  const isParts = plain.startsWith("@");
  const parts = split(isParts ? plain.slice(1) : plain);
  const [x, y, heading, more] = parts;
  if (x === undefined || y === undefined || more !== undefined) throw new Unreadable(`“${text.trim()}” is no place: give ${FORMS}`);
  return headed({ kind: isParts ? "parts" : "numbers", pair: [numberOf(x), numberOf(y)] }, heading);
}
