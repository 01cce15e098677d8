/** `/v1/reachable`: how far energy takes the robot, as areas. */
import { ask, type Asking } from "./ask";
import type { Place } from "./plans";
import type { Robot } from "./robots";

/** From the start to everywhere, from everywhere to the start, or there and back again. */
export type ReachKind = "outward" | "homeward" | "out-and-back";

export interface ReachQuestion {
  map_id: string;
  robot: string | Robot;
  start: Place;
  kind: ReachKind;
  energies_j: number[];
  speed_mps?: number;
}

/** The ground that so much energy reaches. */
export interface Contour {
  energy_j: number;
  area_m2: number;
  /** Polygons, their rings and their points in the map's metres. */
  polygons: [number, number][][][];
}

interface Answer {
  features: { geometry: { coordinates: [number, number][][][] }; properties: { energy_j: number; area_m2: number } }[];
}

/** The contours, the smallest first. As JSON they are in the map's metres; as GeoJSON they would be in longitude and latitude. */
export async function reachable(question: ReachQuestion, asking: Asking = {}): Promise<Contour[]> {
  const { features } = await ask<Answer>("/v1/reachable", { ...asking, accept: "application/json", json: question });
  const contours = features.map(({ geometry, properties }) => ({ ...properties, polygons: geometry.coordinates }));
  return contours.sort((a, b) => a.energy_j - b.energy_j);
}
