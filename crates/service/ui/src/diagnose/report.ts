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
  /** Of its mechanism, summed over explanations. */
  probability?: number;
  scope?: Scope;
}

/** When and where a finding acts; null where it acts always. */
export interface Scope {
  from_s: number | null;
  until_s: number | null;
  run: string | null;
  region: string | null;
}

/** Mechanisms that act together; none where nothing is missing. */
export interface Explanation {
  mechanisms: string[];
  probability: number;
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
  /** The robot's file as it is; the bias is recorded less predicted. */
  file?: { rmse_w: number; bias_w: number; mean_power_w: number; noise_w: number; findings?: { mechanism: string; statement: string }[] };
  probability?: { nothing: number; listed: number; unlisted: number };
  /** The credible set, likeliest first. */
  explanations?: Explanation[];
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
