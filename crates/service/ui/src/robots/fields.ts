/** The fields of a robot: what they mean, their units, and the ranges that the service keeps to (`robot/ranges.rs` of the model). */

import type { MechanismRanges } from "../api/robots";
import { quantity, words } from "../format";
import { escaped } from "./pointer";

export interface Field {
  /** JSON pointer into the robot. */
  pointer: string;
  name: string;
  unit: string;
  least: number;
  greatest: number;
  /** Whether it may be left out. */
  isOptional?: boolean;
  about?: string;
}

export interface FieldGroup {
  name: string;
  fields: Field[];
}

const HALF_PI = Math.PI / 2;

function field(pointer: string, name: string, unit: string, least: number, greatest: number, more: Partial<Field> = {}): Field {
  return { pointer, name, unit, least, greatest, ...more };
}

const motor = (side: "left" | "right"): Field[] => [
  field(`/motors/${side}/k1_w_per_n2`, "k1", "W/N²", 0, 10, { about: "Copper loss per squared wheel force" }),
  field(`/motors/${side}/k2`, "k2", "", 1, 20, { about: "Electrical per mechanical power" }),
  field(`/motors/${side}/force_n_per_a`, "Force per ampere", "N/A", 1e-3, 1e4, {
    isOptional: true,
    about: "Only for recordings of motor current",
  }),
];

export const GROUPS: FieldGroup[] = [
  {
    name: "Body",
    fields: [
      field("/mass_kg", "Mass", "kg", 0.1, 20_000, { about: "With everything on board" }),
      field("/wheelbase_m", "Wheelbase", "m", 0.02, 10, { about: "Front to rear axle" }),
      field("/track_m", "Track", "m", 0.02, 10, { about: "Left to right wheel centres" }),
      field("/slip_track_m", "Slip track", "m", 0.01, 100, {
        isOptional: true,
        about: "Yaw rate is the difference of the sides' speeds over this; half to ten times the track",
      }),
      field("/wheel_radius_m", "Wheel radius", "m", 0.005, 2),
      field("/max_wheel_speed_mps", "Top wheel speed", "m/s", 0.01, 30),
      field("/yaw_inertia_kgm2", "Yaw inertia", "kg m²", 1e-6, 1e6, { isOptional: true }),
    ],
  },
  {
    name: "Centre of mass",
    fields: [
      field("/center_of_mass/forward_m", "Forward", "m", -5, 5, { about: "From the geometric centre, inside the wheels" }),
      field("/center_of_mass/left_m", "Left", "m", -5, 5, { about: "From the geometric centre, inside the wheels" }),
      field("/center_of_mass/height_m", "Height", "m", 0, 5, { about: "Above the ground" }),
    ],
  },
  { name: "Left motor", fields: motor("left") },
  { name: "Right motor", fields: motor("right") },
  {
    name: "Both motors",
    fields: [
      field("/motors/regeneration", "Regeneration", "", 0, 1, { about: "Share of back-driven power that reaches the battery" }),
      field("/motors/reference_temperature_c", "Reference", "°C", -60, 150, { about: "Temperature at which k1 and k2 hold" }),
      field("/motors/resistance_per_k", "Resistance", "1/K", 0, 0.02, { about: "Its rise per kelvin; copper has 0.0039" }),
      field("/motors/motor_constant_per_k", "Motor constant", "1/K", -0.01, 0, { about: "Its rise per kelvin; magnets weaken" }),
    ],
  },
  {
    name: "Electrics",
    fields: [
      field("/hotel_power_w", "Always on", "W", 0, 1e5, { about: "Electronics that never rest" }),
      field("/drive_electronics_w", "Motor drivers", "W", 0, 1e4, { about: "Per side, while driving" }),
      field("/battery/capacity_wh", "Battery capacity", "Wh", 1e-3, 1e6),
      field("/battery/nominal_voltage_v", "Nominal voltage", "V", 1, 1500),
      field("/battery/reserve_fraction", "Reserve", "", 0, 0.99, { about: "Share that must stay" }),
    ],
  },
  {
    name: "Limits",
    fields: [
      field("/limits/max_pitch_rad", "Steepest pitch", "rad", 0.001, HALF_PI),
      field("/limits/max_roll_rad", "Steepest roll", "rad", 0.001, HALF_PI),
      field("/limits/max_side_force_n", "Largest side force", "N", 0.1, 1e6, { isOptional: true }),
    ],
  },
  {
    name: "Uncertainty, relative one sigma",
    fields: [
      field("/uncertainty/mu_roll", "Rolling friction", "", 0, 1),
      field("/uncertainty/mu_skid", "Skid friction", "", 0, 1),
      field("/uncertainty/k1", "k1", "", 0, 1),
      field("/uncertainty/k2", "k2", "", 0, 1),
      field("/uncertainty/mass_kg", "Mass", "", 0, 1),
    ],
  },
];

/** The fields of one kind of ground. */
export function surfaceFields(name: string): Field[] {
  const at = `/surfaces/${escaped(name)}`;
  return [
    field(`${at}/mu_roll`, "Rolling friction μR", "", 0, 2, { about: "Resistance over load" }),
    field(`${at}/mu_skid`, "Skid friction μS", "", 0, 3, { about: "Sideways resistance over load" }),
    field(`${at}/slip_angle_scale_rad`, "Slip angle scale αs", "rad", 0, HALF_PI, { isOptional: true }),
  ];
}

/** A mechanism that a robot or one of its surfaces carries, as a diagnosis puts it there. */
interface Mechanism {
  mechanism: string;
  parameters: Record<string, number>;
}

/** The numbers of the mechanisms under a pointer, with the ranges that the service states for them; open where it states none. */
export function mechanismGroups(mechanisms: unknown, at: string, stated: MechanismRanges[]): FieldGroup[] {
  if (!Array.isArray(mechanisms)) return [];
  return (mechanisms as Mechanism[]).map(({ mechanism, parameters }, i) => {
    const ranges = stated.find((one) => one.mechanism === mechanism)?.parameters ?? [];
    const fields = Object.keys(parameters).map((name) => {
      const pointer = `${at}/mechanisms/${i}/parameters/${name}`;
      const range = ranges.find((one) => one.name === name);
      if (!range) return field(pointer, words(name), "", -Infinity, Infinity);
      const { unit, least, greatest, optional } = range;
      return field(pointer, quantity(name, unit), unit === "1" ? "" : unit, least, greatest, { isOptional: optional });
    });
    return { name: words(mechanism), fields };
  });
}

/** What is wrong with a value, before the service is asked. */
export function complaint({ least, greatest, isOptional, unit }: Field, value: unknown): string | undefined {
  if (value === undefined || value === null) return isOptional ? undefined : "Give a number";
  if (typeof value !== "number" || !Number.isFinite(value)) return "Give a number, as 95.5 or 95,5";
  if (value < least || value > greatest) return `Must lie between ${short(least)} and ${short(greatest)}${unit ? ` ${unit}` : ""}`;
  return undefined;
}

/** The range of a field in words; none where it is open. */
export const bounds = ({ least, greatest, unit }: Field) =>
  Number.isFinite(least) ? `${short(least)} to ${short(greatest)}${unit ? ` ${unit}` : ""}` : "";

const short = (value: number) => String(Number(value.toPrecision(3))).replace("-", "\u2212");
