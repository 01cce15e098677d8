/** Maps: what is at hand, and their cells for drawing. */
import { ask, send } from "./ask";
import { upload } from "./upload";

/** A doubt about a map or a path over it, in a sentence. */
export interface Warning {
  kind: string;
  detail: string;
}

export interface MapSummary {
  id: string;
  /** What people call it. */
  name?: string;
  /** Its coordinate reference system, if it says so. */
  crs?: string;
  rows: number;
  columns: number;
  cell_size_m: number;
  origin_m: [number, number];
  elevation_range_m: [number, number];
  passable_fraction: number;
  surfaces: string[];
  /** Number of areas over it. */
  areas: number;
  warnings: Warning[];
}

/** Cells of a map, row by row from the south-west corner. */
export interface Cells {
  mapId: string;
  rows: number;
  columns: number;
  cell_size_m: number;
  /** South-west corner [m]. */
  x_m: number;
  y_m: number;
  /** Elevation [m], NaN where unknown. */
  z_m: Float32Array;
  /** Index into `surfaces`, 255 where the map names none. */
  surface: Uint8Array;
  obstacle: Uint8Array;
  surfaces: string[];
}

/** More cells than a screen has pixels are not drawn. */
const MOST_CELLS = 1_500_000;

export const listMaps = async () => (await ask<{ maps: MapSummary[] }>("/v1/maps")).maps;

/** Stores a map; `query` says its name and how it is to be read. */
export const storeMap = (body: Blob, contentType: string, query: Record<string, string>, tell: (share: number) => void) =>
  upload<MapSummary>(`/v1/maps?${new URLSearchParams(query)}`, body, contentType, tell);

/** Fetches the cells of a map. */
export async function readCells(map: MapSummary, signal?: AbortSignal): Promise<Cells> {
  const asking = { accept: "application/octet-stream", ...(signal && { signal }) };
  const response = await send(`/v1/maps/${map.id}?max_cells=${MOST_CELLS}`, asking);
  return decode(await response.arrayBuffer(), map);
}

/** The layout stands at `GET /v1/maps/{id}` in /openapi.json. */
function decode(bytes: ArrayBuffer, map: MapSummary): Cells {
  const view = new DataView(bytes);
  const columns = view.getUint32(4, true);
  const rows = view.getUint32(8, true);
  const [cell_size_m, x_m, y_m, base_m] = [16, 24, 32, 40].map((at) => view.getFloat64(at, true)) as [number, number, number, number];
  const count = rows * columns;
  const z_m = new Float32Array(bytes, 48, count).map((relative_m) => base_m + relative_m);
  const surface = new Uint8Array(bytes, 48 + 4 * count, count);
  const obstacle = new Uint8Array(bytes, 48 + 5 * count, count);
  return { mapId: map.id, rows, columns, cell_size_m, x_m, y_m, z_m, surface, obstacle, surfaces: map.surfaces };
}
