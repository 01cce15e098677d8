/** Brings maps and robots in at the start, cells when a map is chosen, and a map that is dropped. */
import { batch, effect, signal } from "@preact/signals";
import { readSettings } from "../api/earth";
import { listMaps, readCells, storeMap, type MapSummary } from "../api/maps";
import { problemOf, type Problem } from "../api/problem";
import { listRobots } from "../api/robots";
import { mapType } from "../api/upload";
import { earth } from "../map/earth";
import { setEnd } from "../map/ends";
import { tileSource } from "../map/tiles";
import { readingQuery } from "./reading_options";
import * as state from "./state";

/** How much of a map has been sent, 0 to 1; null when none is. */
export const sending = signal<number | null>(null);
/** Why maps and robots, or the cells of one, cannot be shown. */
export const loadProblem = signal<Problem | null>(null);

export async function loadRobots(): Promise<void> {
  state.robots.value = await listRobots();
  // A link may name a robot that this service has never had.
  if (!state.robot.value) state.robotId.value = state.robots.value[0]?.id ?? "husky-a200-field";
}

export async function loadAll(): Promise<void> {
  loadProblem.value = null;
  try {
    const [maps, settings] = await Promise.all([listMaps(), readSettings(), loadRobots()]);
    tileSource.value = settings.tiles;
    state.maps.value = maps;
    const isKnown = maps.some(({ id }) => id === state.mapId.value);
    if (!isKnown && state.mapId.value) {
      const detail = `The link shows a map (${state.mapId.value}) that this service does not have. Drop its file here, or choose another.`;
      loadProblem.value = problemOf(new Error(detail));
      [state.mapId.value, state.start.value, state.goal.value, state.stops.value] = [null, null, null, []];
    }
    state.mapId.value ??= maps[0]?.id ?? null;
  } catch (thrown) {
    loadProblem.value = problemOf(thrown);
  }
}

/** Whether map and robot of the question are at hand, so that nothing needs to be fetched. */
export const isAllKnown = () => state.map.value !== null && state.robot.value !== null;

/** Shows another map; ends on the old one mean nothing on it. */
export function chooseMap(id: string): void {
  if (id === state.mapId.value) return;
  state.start.value = state.goal.value = null;
  state.stops.value = [];
  state.tool.value = "start";
  state.problem.value = null;
  state.mapId.value = id;
}

/** Puts a changed map in the place of the one that it was made from. Its ground is the same, and so are the ends. */
export function replaceMap(id: string, changed: MapSummary): void {
  const known = state.maps.value ?? [];
  const at = known.findIndex((map) => map.id === id);
  const others = known.filter((map) => map.id !== changed.id && map.id !== id);
  batch(() => {
    if (state.cells.value?.mapId === id) state.cells.value.mapId = changed.id;
    if (earth.value?.mapId === id) earth.value.mapId = changed.id;
    state.maps.value = at < 0 ? [...others, changed] : [...others.slice(0, at), changed, ...others.slice(at)];
    state.mapId.value = changed.id;
  });
}

function added(map: MapSummary): void {
  const others = state.maps.value?.filter(({ id }) => id !== map.id) ?? [];
  state.maps.value = [...others, map];
  chooseMap(map.id);
}

/** Longest name that the service keeps [characters]. */
const LONGEST_NAME = 200;

async function sent(body: Blob, type: string, name: string): Promise<void> {
  loadProblem.value = null;
  try {
    const query = { name: name.slice(0, LONGEST_NAME), ...readingQuery(type) };
    sending.value = 0;
    added(await storeMap(body, type, query, (share) => (sending.value = share)));
  } catch (thrown) {
    loadProblem.value = problemOf(thrown);
  }
  sending.value = null;
}

export const addMap = (file: File) => sent(file, mapType(file.name), file.name);

/** What the sample map is called. */
export const SAMPLE_NAME = "minnesota.tif";

/** The service carries a piece of Minnesota for who has no map at hand. */
export async function addSample(): Promise<void> {
  const sample = await fetch("/sample-map.tif");
  await sent(await sample.blob(), "image/tiff", SAMPLE_NAME);
  const map = state.map.value;
  if (!map) return;
  const middle_m = map.cell_size_m / 2;
  const at = (u: number, v: number) => ({
    x_m: map.origin_m[0] + u * map.columns * map.cell_size_m + middle_m,
    y_m: map.origin_m[1] + v * map.rows * map.cell_size_m + middle_m,
  });
  // The ends of `joulepath demo`.
  setEnd("start", at(0.08, 0.12));
  setEnd("goal", at(0.9, 0.88));
  state.tool.value = "move";
}

/** Begins to fetch the cells of the chosen map. */
export function followMap(): void {
  let latest = new AbortController();
  effect(() => {
    const map = state.map.value;
    latest.abort();
    latest = new AbortController();
    if (state.cells.peek()?.mapId !== map?.id) state.cells.value = null;
    if (!map || state.cells.peek()) return;
    const { signal } = latest;
    readCells(map, signal).then(
      (cells) => (state.cells.value = cells),
      (thrown) => signal.aborted || (loadProblem.value = problemOf(thrown)),
    );
  });
}
