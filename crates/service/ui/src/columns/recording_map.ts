/** Picks as the map that the service reads a recording with. */
import { channelOf, isWheelSpeed, RATES } from "./channels";
import type { Pick } from "./guess";
import { isOfTopics, type Column } from "./table";

export interface RecordingMap {
  name: string;
  wheel_radius_m?: number;
  sources: Source[];
}

/** What a channel is taken from: a column, or a field of a topic. */
interface Source {
  channel: string;
  column?: string;
  topic?: string;
  fields?: string[];
  unit?: string;
  scale?: number;
}

/** Where a column stands, in the words of a map. */
const placeOf = ({ name, topic }: Column) => (topic === undefined ? { column: name } : { topic, fields: [name] });
const isFrom = ({ column, topic, fields }: Source, of: Column) =>
  of.topic === undefined ? column === of.name : topic === of.topic && fields?.length === 1 && fields[0] === of.name;

export const needsRadius = (picks: Pick[]) =>
  picks.some(({ channel, unit }) => channel !== null && isWheelSpeed(channel) && RATES.includes(unit));

/** What is still missing before a file can be read; null where nothing is. Messages of topics have times of their own. */
export function missing(columns: Column[], picks: Pick[], wheelRadius_m: number | null): string | null {
  const has = (...channels: string[]) => channels.every((name) => picks.some(({ channel }) => channel === name));
  const names = picks.flatMap(({ channel }) => channel ?? []);
  const twice = names.find((name, i) => names.indexOf(name) !== i);
  if (twice) return `Two columns are the ${channelOf(twice)?.label.toLowerCase() ?? twice}: leave one out.`;
  if (!has("t_s") && !isOfTopics(columns)) return "Say which column is the time.";
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
  return columns.map((column) => {
    const source = sources.find((one) => isFrom(one, column));
    const own = source && channelOf(source.channel)?.units[0];
    return { channel: source?.channel ?? null, unit: source?.unit ?? own ?? "", isTurned: source?.scale === -1 };
  });
}

/** The map for the picks. Dates need no unit. */
export function mapOf(columns: Column[], picks: Pick[], wheelRadius_m: number | null, isDated: boolean): RecordingMap {
  const sources = picks.flatMap(({ channel, unit, isTurned }, i) => {
    if (channel === null) return [];
    const hasUnit = unit !== "" && !(channel === "t_s" && isDated);
    return [{ channel, ...placeOf(columns[i]!), ...(hasUnit && { unit }), ...(isTurned && { scale: -1 }) }];
  });
  return {
    name: "columns picked on the page",
    ...(needsRadius(picks) && wheelRadius_m !== null && { wheel_radius_m: wheelRadius_m }),
    sources,
  };
}
