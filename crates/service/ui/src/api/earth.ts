/** Where on earth a map lies, and pictures of that ground from elsewhere. */
import { ask } from "./ask";
import type { MapSummary } from "./maps";

/** Pairs of numbers at even steps over a rectangle, row by row. */
export interface Lattice {
  columns: number;
  rows: number;
  nodes: [number, number][];
}

/** What `GET /v1/maps/{id}/earth` answers, as the page uses it. */
export interface Earth {
  mapId: string;
  /** Heading of true north in the map's middle, counter-clockwise from east [rad]. */
  true_north_rad: number;
  /** Longitude and latitude [°], from the south-west corner. */
  degrees: Lattice;
  /** x and y of the map [m], over `bounds`, from their north-west corner. */
  tiles: Lattice;
  /** West, north, east and south of the map in the square that tiles are cut from. */
  bounds: [number, number, number, number];
}

interface Answer {
  true_north_rad: number;
  degrees: { columns: number; rows: number; places_deg: [number, number][] };
  web_mercator: { bounds: [number, number, number, number]; columns: number; rows: number; places_m: [number, number][] };
}

export async function readEarth(map: MapSummary, signal: AbortSignal): Promise<Earth> {
  const { true_north_rad, degrees, web_mercator } = await ask<Answer>(`/v1/maps/${map.id}/earth`, { signal });
  return {
    mapId: map.id,
    true_north_rad,
    degrees: { columns: degrees.columns, rows: degrees.rows, nodes: degrees.places_deg },
    tiles: { columns: web_mercator.columns, rows: web_mercator.rows, nodes: web_mercator.places_m },
    bounds: web_mercator.bounds,
  };
}

/** Where the service was told to take tiles from. */
export interface TileSource {
  /** Address of a tile with `{z}`, `{x}` and `{y}`. */
  url: string;
  attribution: string;
  max_zoom: number;
}

export const readSettings = () => ask<{ tiles: TileSource | null }>("/page/settings.json");
