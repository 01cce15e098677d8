/** What each column may hold, guessed from its name and the size of its numbers, as `joulepath inspect` does. */
import { CHANNELS, channelOf, type Channel } from "./channels";
import { isDate, isOfTopics, numberOf, titleOf, type Column } from "./table";

/** What is said of a column; none where it is left out. */
export interface Pick {
  channel: string | null;
  unit: string;
  /** Whether the sign is turned. */
  isTurned: boolean;
}

interface Known {
  channel: string;
  /** All of these groups have a word in the name, … */
  all: string[][];
  /** … and this has none. */
  none?: string[];
}

const LEFT = ["left", "l", "fl", "rl", "lf", "lr", "lhs"];
const RIGHT = ["right", "r", "fr", "rr", "rf", "rhs"];
const SPEED = ["speed", "vel", "velocity", "rpm", "v", "wheel", "encoder"];
const POWER = ["power", "watt", "watts", "pwr", "w", "p"];
const CURRENT = ["current", "amp", "amps", "a", "ma", "i"];
const BATTERY = ["battery", "bat", "batt", "total", "pack"];
const OTHERS = ["cmd", "command", "target", "setpoint", "desired", "temp", "temperature", "voltage", "position", "accel"];

const KNOWN: Known[] = [
  { channel: "motor_temp_left_c", all: [LEFT, ["temp", "temperature"]] },
  { channel: "motor_temp_right_c", all: [RIGHT, ["temp", "temperature"]] },
  { channel: "power_left_w", all: [LEFT, ["power", "watt", "watts", "pwr"]], none: OTHERS },
  { channel: "power_right_w", all: [RIGHT, ["power", "watt", "watts", "pwr"]], none: OTHERS },
  { channel: "motor_current_left_a", all: [LEFT, ["current", "amp", "amps", "ma"]], none: OTHERS },
  { channel: "motor_current_right_a", all: [RIGHT, ["current", "amp", "amps", "ma"]], none: OTHERS },
  { channel: "v_left_mps", all: [LEFT, SPEED], none: OTHERS },
  { channel: "v_right_mps", all: [RIGHT, SPEED], none: OTHERS },
  {
    channel: "yaw_rate_radps",
    all: [
      ["yaw", "gyro", "angular"],
      ["rate", "z", "gz", "dps", "rad"],
    ],
    none: OTHERS,
  },
  { channel: "heading_rad", all: [["heading", "yaw", "bearing"]], none: ["rate", "cmd"] },
  { channel: "pitch_rad", all: [["pitch"]], none: ["rate", "cmd"] },
  { channel: "roll_rad", all: [["roll"]], none: ["rate", "cmd"] },
  {
    channel: "ambient_temp_c",
    all: [
      ["ambient", "air"],
      ["temp", "temperature", "c"],
    ],
  },
  { channel: "power_w", all: [POWER, [...BATTERY, "power", "watt", "watts"]], none: ["cmd", "left", "right"] },
  { channel: "current_a", all: [CURRENT, [...BATTERY, "current", "amps"]], none: ["cmd", "left", "right"] },
  {
    channel: "voltage_v",
    all: [
      ["voltage", "volt", "volts", "v", "u", "mv"],
      [...BATTERY, "voltage", "volts", "volt"],
    ],
    none: ["cmd"],
  },
];

const TIMES = ["t", "time", "stamp", "timestamp", "secs", "seconds", "elapsed", "clock"];

/** Lower-case words of a name, cut at signs, digits and changes of case. */
const wordsOf = (name: string) =>
  name
    .replace(/(\p{Ll})(\p{Lu}\p{Ll})/gu, "$1 $2")
    .toLowerCase()
    .split(/[^\p{L}]+/u)
    .filter((word) => word !== "");

/** Other spellings of units. */
const SPELLINGS: Record<string, string[]> = {
  "rad/s": ["radps", "rad_s", "rad_per_s"],
  "deg/s": ["degps", "deg_s", "dps"],
  "km/h": ["kmh", "kph"],
  "mm/s": ["mmps", "mm_s"],
  "cm/s": ["cmps", "cm_s"],
  "m/s": ["mps", "m_s"],
  deg: ["°", "degrees", "grad"],
  degF: ["fahrenheit"],
  K: ["kelvin"],
};

/** The unit that stands in a name: the longest that does, so that `mrad` is not `rad`. */
function spelled(name: string, units: string[]): string | undefined {
  const [lower, words] = [name.toLowerCase(), wordsOf(name)];
  const stands = (text: string) => (/^\p{L}+$/u.test(text) ? words.includes(text.toLowerCase()) : lower.includes(text.toLowerCase()));
  return [...units].sort((a, b) => b.length - a.length).find((unit) => [unit, ...(SPELLINGS[unit] ?? [])].some(stands));
}

/** Magnitudes beyond which numbers are in another unit than the channel's own: the faster one first. */
const BEYOND: Record<string, [number, string][]> = {
  v_left_mps: [
    [60, "rpm"],
    [6, "rad/s"],
  ],
  v_right_mps: [
    [60, "rpm"],
    [6, "rad/s"],
  ],
  pitch_rad: [[Math.PI / 2, "deg"]],
  roll_rad: [[Math.PI / 2, "deg"]],
  heading_rad: [[2 * Math.PI + 0.1, "deg"]],
  yaw_rate_radps: [[10, "deg/s"]],
  voltage_v: [[1000, "mV"]],
  current_a: [[1000, "mA"]],
  power_w: [[50_000, "mW"]],
  // Seconds since 1970 are 1.8e9 now.
  t_s: [
    [1e17, "ns"],
    [1e14, "us"],
    [1e11, "ms"],
  ],
};

/** The greatest magnitude of a column's numbers; NaN where it has none. */
function greatestOf({ cells }: Column): number {
  const sizes = cells.map((cell) => Math.abs(numberOf(cell))).filter((size) => Number.isFinite(size));
  return sizes.length > 0 ? sizes.reduce((a, b) => Math.max(a, b)) : NaN;
}

function channelFor(name: string): string | null {
  if (channelOf(name)) return name;
  const words = wordsOf(name);
  const has = (any: string[]) => words.some((word) => any.includes(word));
  const found = KNOWN.find(({ all, none = ["cmd"] }) => all.every(has) && !has(none));
  if (found) return found.channel;
  if (has(TIMES)) return "t_s";
  return words.length === 1 && (has(["run"]) || has(["surface"])) ? words[0]! : null;
}

/** The channels that columns may hold: numbers of topics are neither times nor names. */
export const offered = (columns: Column[]) =>
  isOfTopics(columns) ? CHANNELS.filter(({ name, units }) => name !== "t_s" && units.length > 0) : CHANNELS;

export function guess(column: Column): Pick {
  const name = channelFor(column.topic === undefined ? column.name : fieldWords(column));
  const channel = name && channelOf(name);
  if (!channel || !offered([column]).includes(channel)) return LEFT_OUT;
  const isText = Number.isNaN(greatestOf(column)) && !column.cells.some(isDate);
  if (isText && channel.units.length > 0) return LEFT_OUT;
  return { channel: channel.name, unit: unitFor(column, channel), isTurned: false };
}

/** What tells of a field: its path, whose last words weigh most, behind the words of its topic. */
const fieldWords = (column: Column) => titleOf(column).replace(/\[\d+\]/g, "");

const LEFT_OUT: Pick = { channel: null, unit: "", isTurned: false };

/** The unit of a column that holds a channel: what its name says, else what the size of its numbers says, else the channel's own. */
export function unitFor(column: Column, { name, units }: Channel): string {
  const [own = ""] = units;
  const byRange = BEYOND[name]?.find(([most]) => greatestOf(column) > most)?.[1];
  return (column.name === name ? own : spelled(column.name, units)) ?? byRange ?? own;
}

/** Rows without which numbers that rise may do so by chance. */
const LEAST_RISING = 10;

/** Whether the numbers of a column rise from row to row. */
function rises({ cells }: Column): boolean {
  const numbers = cells.map(numberOf);
  return numbers.length >= LEAST_RISING && numbers.every((number, i) => i === 0 || number > numbers[i - 1]!);
}

/** A guess for every column; of several that guess the same the first is taken. Where no name says time, a first column that rises is. */
export function guessAll(columns: Column[]): Pick[] {
  const seen = new Set<string>();
  const picks = columns.map((column) => {
    const pick = guess(column);
    if (pick.channel === null || !seen.has(pick.channel)) {
      if (pick.channel) seen.add(pick.channel);
      return pick;
    }
    return { ...pick, channel: null };
  });
  const [first] = columns;
  const time = channelOf("t_s");
  if (first && time && !isOfTopics(columns) && !seen.has("t_s") && picks[0]?.channel === null && rises(first))
    picks[0] = { channel: "t_s", unit: unitFor(first, time), isTurned: false };
  return picks;
}
