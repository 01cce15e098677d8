/** What `POST /v1/calibrate` finds, as its job's result has it. */
import type { Robot } from "../api/robots";

export interface Parameter {
  /** Path into the robot, with dots. */
  name: string;
  value: number;
  unit: string;
  interval_95: [number, number] | null;
  /** Whether the drives say it; else it is held at what was known before. */
  determined: boolean;
}

interface Coverage {
  recorded_s: number;
  used_s: number;
  left_out: { duration_s: number; reason: string }[];
}

/** Skill of a prediction; `second` means averages over a second. Current recordings have amperes in place of watts. */
export interface Skill {
  rmse_w?: number;
  r2?: number;
  second_r2?: number;
  second_rmse_w?: number;
  r2_a?: number;
  rmse_a?: number;
}

export interface Calibration {
  parameters: Parameter[];
  held_out: (Skill & { median_energy_error_percent?: number }) | null;
  as_written?: Skill;
  coverage?: { total: Coverage; runs: (Coverage & { run: string })[] };
  notes: string[];
  robot: Robot;
}
