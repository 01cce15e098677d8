/** From the map's metres to longitude and latitude and back, by the lattice that the service gives. */
import { effect, signal } from "@preact/signals";
import { readEarth, type Earth } from "../api/earth";
import type { Place } from "../api/plans";
import * as state from "../plan/state";
import { between, partsOf } from "./lattice";
import { extentOf } from "./view";

/** Where on earth the map lies; null where nothing says it, or not yet. */
export const earth = signal<Earth | null>(null);

/** Begins to ask where each map lies that is shown. */
export function followEarth(): void {
  let latest = new AbortController();
  effect(() => {
    const map = state.map.value;
    if (map && earth.peek()?.mapId === map.id) return;
    latest.abort();
    latest = new AbortController();
    earth.value = null;
    if (!map?.crs) return;
    // A system that is not placed on earth leaves the map's own metres.
    readEarth(map, latest.signal).then(
      (found) => (earth.value = found),
      () => undefined,
    );
  });
}

export interface Degrees {
  lon_deg: number;
  lat_deg: number;
}

/** Longitude and latitude of a place of the map, where they are known. */
export function degreesOf({ x_m, y_m }: Place): Degrees | null {
  const [known, map] = [earth.value, state.map.value];
  if (!known || !map) return null;
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  const [lon_deg, lat_deg] = between(known.degrees, [(x_m - west_m) / width_m, (y_m - south_m) / height_m]);
  return { lon_deg, lat_deg };
}

/** The place of the map at a longitude and latitude, where the map says where on earth it lies. */
export function placeOf({ lon_deg, lat_deg }: Degrees): Place | null {
  const [known, map] = [earth.value, state.map.value];
  if (!known || !map) return null;
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  const [right, up] = partsOf(known.degrees, [lon_deg, lat_deg]);
  return Number.isFinite(right) && Number.isFinite(up) ? { x_m: west_m + right * width_m, y_m: south_m + up * height_m } : null;
}

/** Six digits are a tenth of a metre. */
const PLACES = 6;

/** Latitude and longitude as people write them. */
export const degreesWords = ({ lon_deg, lat_deg }: Degrees) =>
  `${Math.abs(lat_deg).toFixed(PLACES)}°\u202f${lat_deg < 0 ? "S" : "N"}, ${Math.abs(lon_deg).toFixed(PLACES)}°\u202f${lon_deg < 0 ? "W" : "E"}`;
