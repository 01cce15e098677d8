/** What `POST /v1/diagnose` finds, as its job's result has it. */
import type { Robot } from "../api/robots";

export interface Range {
  quantity: string;
  from: number | null;
  to: number | null;
  name: string | null;
  /** Of a place, from west to east and from south to north; none where it is open. */
  x_m?: Bounds;
  y_m?: Bounds;
}

export type Bounds = [number | null, number | null];

export interface Difference {
  kind: "time" | "place" | "regime" | "channel";
  statement: string;
  range: Range;
  share_of_excess: number;
}

export interface Finding {
  mechanism: string;
  statement: string;
  equation: string;
  parameters: { name: string; value: number; unit: string; interval_95: [number, number] | null }[];
  evidence: { p_value: number; delta_bic: number; held_out_gain: number };
  indistinguishable_from: string[];
  fit: { held_out_rmse_before_w: number; held_out_rmse_after_w: number };
}

/** Power over the time driven, all channels together. */
export interface Trace {
  run: number[];
  t_s: number[];
  recorded_w: (number | null)[];
  filed_w: (number | null)[];
  corrected_w: (number | null)[];
  runs: string[];
  position_m: ([number, number] | null)[];
}

export interface Report {
  verdict: "consistent" | "explained" | "ambiguous" | "unexplained";
  sentence: string;
  baseline: { rmse_w: number; bias_w: number; held_out_rmse_w: number; noise_floor_w: number };
  where: Difference[];
  findings: Finding[];
  corrected: { rmse_w: number; held_out_rmse_w: number };
  next_drive: string | null;
  detectable: { mechanism: string; parameter: string; value: number; unit: string }[];
  not_judged: string[];
  notes: string[];
  robot: Robot;
  trace?: Trace;
}
