/** Every change of the areas is stored as a map of its own, shown, and can be undone. */
import { batch, effect, untracked } from "@preact/signals";
import { announce } from "../announce";
import { documentOf, readAreas, storeAreas, type Area } from "../api/areas";
import { isAbort } from "../api/ask";
import type { MapSummary } from "../api/maps";
import { problemOf } from "../api/problem";
import { replaceMap } from "../plan/load";
import * as plan from "../plan/state";
import * as state from "./state";

/** Changes are stored one after another. */
let storing: Promise<void> = Promise.resolve();
/** Raised where a change is refused: those that were made on top of it fall with it. */
let refusals = 0;

/** Puts another version in the place of the chosen map. */
function show(next: state.Version): void {
  const map = plan.map.value;
  if (map) replaceMap(map.id, next.map);
  state.version.value = next;
}

/** Shows a change at once and stores it; one that the service refuses is undone, and said. */
export function change(areas: Area[], said: string): Promise<void> {
  const before = state.version.value;
  if (!before) return storing;
  state.version.value = { ...before, areas };
  return store(
    (map) => storeAreas(map.id, documentOf(areas)),
    async () => areas,
    said,
    before.areas,
  );
}

/** Stores a document in the place of all areas, as it is. */
export function takeDocument(document: unknown, said: (areas: Area[]) => string): Promise<void> {
  const before = state.version.value;
  if (!before) return storing;
  const read = (map: MapSummary) => readAreas(map.id, new AbortController().signal);
  return store((map) => storeAreas(map.id, document), read, said, before.areas);
}

function store(
  ask: (map: MapSummary) => Promise<MapSummary>,
  areasOf: (map: MapSummary) => Promise<Area[]>,
  said: string | ((areas: Area[]) => string),
  before: Area[],
): Promise<void> {
  const known = refusals;
  const run = async () => {
    const map = plan.map.value;
    if (!map || known !== refusals || state.version.value?.map.id !== map.id) return;
    state.isStoring.value = true;
    try {
      const stored = await ask(map);
      const areas = await areasOf(stored);
      if (plan.map.value?.id !== map.id) return;
      batch(() => {
        const shown = state.version.value;
        state.past.value = [...state.past.value, { map, areas: before }];
        state.future.value = [];
        state.problem.value = null;
        // Changes that wait to be stored are shown already.
        show({ map: stored, areas: typeof said === "string" && shown ? shown.areas : areas });
      });
      announce(typeof said === "string" ? said : said(areas));
    } catch (thrown) {
      refusals += 1;
      batch(() => {
        state.problem.value = problemOf(thrown);
        state.selected.value = null;
        if (state.version.value) state.version.value = { ...state.version.value, areas: before };
      });
    } finally {
      state.isStoring.value = false;
    }
  };
  storing = storing.then(run);
  return storing;
}

function step(from: typeof state.past, to: typeof state.past, said: string): void {
  const [next, now] = [from.value.at(-1), state.version.value];
  if (!next || !now || state.isStoring.value) return;
  batch(() => {
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, now];
    state.selected.value = null;
    state.preview.value = null;
    state.problem.value = null;
    show(next);
  });
  announce(said);
}

export const undo = () => step(state.past, state.future, "Undone.");
export const redo = () => step(state.future, state.past, "Done again.");

/** Begins to fetch the areas of each map that is chosen. */
export function followAreas(): void {
  let latest = new AbortController();
  effect(() => {
    const map = plan.map.value;
    untracked(() => {
      if (state.version.value?.map.id === map?.id) return;
      latest.abort();
      latest = new AbortController();
      batch(() => {
        state.version.value = map && map.areas === 0 ? { map, areas: [] } : null;
        [state.past.value, state.future.value, state.corners.value] = [[], [], []];
        [state.selected.value, state.preview.value, state.problem.value] = [null, null, null];
        state.mode.value = map && map.areas > 0 ? "select" : "polygon";
      });
      if (!map || map.areas === 0) return;
      readAreas(map.id, latest.signal).then(
        (areas) => (state.version.value = { map, areas }),
        (thrown) => isAbort(thrown) || (state.problem.value = problemOf(thrown)),
      );
    });
  });
}
