/** Places along a path. */
import type { Pose } from "../api/plans";
import type { Point, Size, View } from "./view";
import { toPixel } from "./view";

/** The pose at a distance, between the two around it. */
export function poseAt(poses: Pose[], distance_m: number): Pose | null {
  const after = indexAt(poses, distance_m);
  const [a, b] = [poses[Math.max(after - 1, 0)], poses[after]];
  if (!a || !b) return null;
  const length_m = b.distance_m - a.distance_m;
  const t = length_m > 0 ? Math.min(Math.max((distance_m - a.distance_m) / length_m, 0), 1) : 1;
  const between = (from: number, to: number) => from + t * (to - from);
  const turn = Math.atan2(Math.sin(b.heading_rad - a.heading_rad), Math.cos(b.heading_rad - a.heading_rad));
  return {
    ...b,
    x_m: between(a.x_m, b.x_m),
    y_m: between(a.y_m, b.y_m),
    z_m: between(a.z_m, b.z_m),
    t_s: between(a.t_s, b.t_s),
    energy_j: between(a.energy_j, b.energy_j),
    heading_rad: a.heading_rad + t * turn,
    distance_m,
  };
}

/** The first pose at or beyond a distance. */
function indexAt(poses: Pose[], distance_m: number): number {
  let [low, high] = [0, poses.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (poses[middle]!.distance_m < distance_m) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The pose nearest to a pixel, and how far off it is in pixels. */
export function nearest(poses: Pose[], view: View, size: Size, to: Point): { pose: Pose; off: number } | null {
  let best: { pose: Pose; off: number } | null = null;
  for (const pose of poses) {
    const { x, y } = toPixel(view, size, pose.x_m, pose.y_m);
    const off = Math.hypot(x - to.x, y - to.y);
    if (!best || off < best.off) best = { pose, off };
  }
  return best;
}
