/** `/v1/reachable`: how far a charge takes the robot, as areas. */
import { ask, type Asking } from "./ask";
import type { Place } from "./plans";
import type { Robot } from "./robots";

export interface ReachQuestion {
  map_id: string;
  robot: string | Robot;
  start: Place;
  speed_mps?: number;
  charge: number;
}

/** One contour: what can be reached with so much energy. */
export interface Contour {
  energy_j: number;
  /** Rings of polygons in the map's metres. */
  polygons: [number, number][][][];
}

interface Feature {
  geometry: { type: "Polygon"; coordinates: [number, number][][] } | { type: "MultiPolygon"; coordinates: [number, number][][][] };
  properties: Record<string, unknown>;
}

/** The contours, largest area last. */
export async function reachable(question: ReachQuestion, asking: Asking = {}): Promise<Contour[]> {
  const accept = "application/geo+json, application/json;q=0.5";
  const answer = await ask<{ features: Feature[] }>("/v1/reachable", { ...asking, accept, json: question });
  const contours = answer.features.map(({ geometry, properties }) => ({
    energy_j: Number(properties.energy_j ?? 0),
    polygons: geometry.type === "Polygon" ? [geometry.coordinates] : geometry.coordinates,
  }));
  return contours.sort((a, b) => a.energy_j - b.energy_j);
}
