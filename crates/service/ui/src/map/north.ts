/** The direction of the north arrow. */

/** Grid north stands for true north up to so much [°]. */
const TOLD_DEG = 1;

export interface North {
  /** Clockwise from the top of the map [°]. */
  turn_deg: number;
  title: string;
}

/** By the heading of true north, counter-clockwise from east [rad]; null where nothing says where on earth the map lies. */
export function northOf(true_north_rad: number | null): North {
  if (true_north_rad === null) return { turn_deg: 0, title: "North by the map's y axis" };
  const turn_deg = 90 - (true_north_rad * 180) / Math.PI;
  const apart = `${Math.abs(turn_deg).toFixed(1)}°`;
  if (Math.abs(turn_deg) <= TOLD_DEG) return { turn_deg: 0, title: `Grid north, ${apart} from true north` };
  return { turn_deg, title: `True north; the map's grid is turned ${apart} ${turn_deg > 0 ? "west" : "east"} of it` };
}
