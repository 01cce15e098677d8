/** What an area changes, in the page's words. */
import type { AreaProperties } from "../api/areas";
import { degrees, words } from "../format";

export const KINDS = ["keep_out", "surface", "max_speed_mps", "cost_factor", "one_way_rad"] as const;
export type Kind = (typeof KINDS)[number];

/** The name of each kind, and its colour in the style sheet. */
export const KIND: Record<Kind, { name: string; color: string }> = {
  keep_out: { name: "Keep out", color: "area-keep-out" },
  surface: { name: "Surface", color: "area-surface" },
  max_speed_mps: { name: "Speed limit", color: "area-speed" },
  cost_factor: { name: "Cost factor", color: "area-cost" },
  one_way_rad: { name: "One way", color: "area-way" },
};

/** The values of an area that is drawn next, until others are chosen. */
export const USUAL: Required<Pick<AreaProperties, Kind>> = {
  keep_out: true,
  surface: null,
  max_speed_mps: 0.5,
  cost_factor: 3,
  one_way_rad: 0,
};

/** The kinds of an area, the one that it is drawn as first. */
export const kindsOf = (properties: AreaProperties): Kind[] =>
  KINDS.filter((kind) => properties[kind] !== undefined && properties[kind] !== null && properties[kind] !== false);

export const kindOf = (properties: AreaProperties): Kind => kindsOf(properties)[0] ?? "keep_out";

/** As it was given, to the thousandth. */
const written = (value: unknown) => String(Number(Number(value).toFixed(3)));

function oneInWords(kind: Kind, properties: AreaProperties): string {
  const value = properties[kind];
  if (kind === "keep_out") return "keep out";
  if (kind === "surface") return words(String(value));
  if (kind === "max_speed_mps") return `≤ ${written(value)}\u202fm/s`;
  if (kind === "cost_factor") return `cost × ${written(value)}`;
  return `one way ${degrees(Number(value), 0)}`;
}

/** Everything that an area changes, in a few words. */
export const inWords = (properties: AreaProperties) =>
  kindsOf(properties)
    .map((kind) => oneInWords(kind, properties))
    .join(", ");

/** An area's properties with another effect in place of the one that it is drawn as; what else it changes stays. */
export function withEffect(properties: AreaProperties, kind: Kind, value: AreaProperties[Kind]): AreaProperties {
  const { [kindOf(properties)]: _, ...others } = properties;
  return { ...others, [kind]: value };
}
