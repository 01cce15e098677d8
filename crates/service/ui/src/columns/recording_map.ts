/** Picks as the map that the service reads a recording with. */
import { channelOf, isWheelSpeed, RATES } from "./channels";
import type { Pick } from "./guess";
import type { Column } from "./table";

export interface RecordingMap {
  name: string;
  wheel_radius_m?: number;
  sources: { channel: string; column: string; unit?: string; scale?: number }[];
}

export const needsRadius = (picks: Pick[]) =>
  picks.some(({ channel, unit }) => channel !== null && isWheelSpeed(channel) && RATES.includes(unit));

/** What is still missing before a file can be read; null where nothing is. */
export function missing(picks: Pick[], wheelRadius_m: number | null): string | null {
  const has = (...channels: string[]) => channels.every((name) => picks.some(({ channel }) => channel === name));
  const names = picks.flatMap(({ channel }) => channel ?? []);
  const twice = names.find((name, i) => names.indexOf(name) !== i);
  if (twice) return `Two columns are the ${channelOf(twice)?.label.toLowerCase() ?? twice}: leave one out.`;
  if (!has("t_s")) return "Say which column is the time.";
  for (const name of ["v_left_mps", "v_right_mps"])
    if (!has(name)) return `Say which column is the ${channelOf(name)!.label.toLowerCase()}.`;
  const hasPower =
    has("power_w") ||
    has("current_a", "voltage_v") ||
    has("power_left_w", "power_right_w") ||
    has("motor_current_left_a", "motor_current_right_a");
  if (!hasPower) return "Say which column is the power: of the battery or both motors, current and voltage, or the motors' currents.";
  if (needsRadius(picks) && wheelRadius_m === null) return "Rates of the wheels need the wheel radius.";
  return null;
}

/** What a map says of each column. */
export function picksOf(columns: Column[], { sources }: RecordingMap): Pick[] {
  return columns.map(({ name }) => {
    const source = sources.find(({ column }) => column === name);
    const own = source && channelOf(source.channel)?.units[0];
    return { channel: source?.channel ?? null, unit: source?.unit ?? own ?? "", isTurned: source?.scale === -1 };
  });
}

/** The map for the picks. Dates need no unit. */
export function mapOf(columns: Column[], picks: Pick[], wheelRadius_m: number | null, isDated: boolean): RecordingMap {
  const sources = picks.flatMap(({ channel, unit, isTurned }, i) => {
    if (channel === null) return [];
    const hasUnit = unit !== "" && !(channel === "t_s" && isDated);
    return [{ channel, column: columns[i]!.name, ...(hasUnit && { unit }), ...(isTurned && { scale: -1 }) }];
  });
  return {
    name: "columns picked on the page",
    ...(needsRadius(picks) && wheelRadius_m !== null && { wheel_radius_m: wheelRadius_m }),
    sources,
  };
}
