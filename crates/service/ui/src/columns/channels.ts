/** The channels that a column may hold, with the units in which each may come; names are those of the recording map. */

export interface Channel {
  name: string;
  label: string;
  /** The unit it is kept in comes first. */
  units: string[];
}

const TIME = ["s", "ms", "us", "ns", "min", "h", "d"];
/** Rates of the wheel become speeds by its radius. */
export const RATES = ["rad/s", "deg/s", "rpm"];
const SPEED = ["m/s", "mm/s", "cm/s", "km/h", "mph", ...RATES];
const ANGLE = ["rad", "deg", "mrad"];
const POWER = ["W", "kW", "mW"];
const CURRENT = ["A", "mA"];
const TEMPERATURE = ["degC", "K", "degF"];
const LENGTH = ["m", "mm", "cm", "km", "ft"];

export const CHANNELS: Channel[] = [
  { name: "t_s", label: "Time", units: TIME },
  { name: "v_left_mps", label: "Left wheel speed", units: SPEED },
  { name: "v_right_mps", label: "Right wheel speed", units: SPEED },
  { name: "power_w", label: "Battery power", units: POWER },
  { name: "current_a", label: "Battery current", units: CURRENT },
  { name: "voltage_v", label: "Battery voltage", units: ["V", "mV", "kV"] },
  { name: "power_left_w", label: "Left motor power", units: POWER },
  { name: "power_right_w", label: "Right motor power", units: POWER },
  { name: "motor_current_left_a", label: "Left motor current", units: CURRENT },
  { name: "motor_current_right_a", label: "Right motor current", units: CURRENT },
  { name: "pitch_rad", label: "Pitch, nose up", units: ANGLE },
  { name: "roll_rad", label: "Roll, left side up", units: ANGLE },
  { name: "yaw_rate_radps", label: "Yaw rate, left", units: RATES },
  { name: "heading_rad", label: "Heading from east, left", units: ANGLE },
  { name: "accel_forward_mps2", label: "Forward acceleration", units: ["m/s2", "g", "mg"] },
  { name: "x_m", label: "Position east", units: LENGTH },
  { name: "y_m", label: "Position north", units: LENGTH },
  { name: "z_m", label: "Height", units: LENGTH },
  { name: "motor_temp_left_c", label: "Left motor temperature", units: TEMPERATURE },
  { name: "motor_temp_right_c", label: "Right motor temperature", units: TEMPERATURE },
  { name: "ambient_temp_c", label: "Air temperature", units: TEMPERATURE },
  { name: "run", label: "Name of the drive", units: [] },
  { name: "surface", label: "Name of the ground", units: [] },
];

export const channelOf = (name: string) => CHANNELS.find((channel) => channel.name === name);
/** Speeds of the sides: the only channels whose rates need the radius of the wheels. */
export const isWheelSpeed = (name: string) => name === "v_left_mps" || name === "v_right_mps";
