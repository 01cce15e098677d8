/** Areas over a map: GeoJSON in the map's metres, with the property names of docs/steering.md. */
import { ask } from "./ask";
import type { MapSummary } from "./maps";

/** East and north [m]. */
export type Position = [number, number];

export interface AreaProperties {
  keep_out?: boolean | null;
  surface?: string | null;
  max_speed_mps?: number | null;
  cost_factor?: number | null;
  /** Counter-clockwise from east. */
  one_way_rad?: number | null;
  [other: string]: unknown;
}

export type Geometry =
  | { type: "Polygon" | "MultiLineString"; coordinates: Position[][] }
  | { type: "MultiPolygon"; coordinates: Position[][][] }
  | { type: "LineString"; coordinates: Position[] };

export interface Area {
  type: "Feature";
  properties: AreaProperties;
  geometry: Geometry;
}

/** Areas as a document in the map's metres. */
export const documentOf = (features: Area[]) => ({ type: "FeatureCollection", crs: null, features });

/** The areas of a map in its metres, whatever system they were given in. */
export const readAreas = async (mapId: string, signal: AbortSignal) =>
  (await ask<{ features: Area[] }>(`/v1/maps/${mapId}/areas?frame=map`, { accept: "application/geo+json", signal })).features;

/** Stores the map with other areas, under an id of its own. */
export const storeAreas = (mapId: string, areas: unknown) => ask<MapSummary>(`/v1/maps/${mapId}`, { method: "PATCH", json: { areas } });
