/** Energy contours: how far the charge goes. The service may not have them; then the page does not offer them. */
import { effect } from "@preact/signals";
import { isAbort } from "../api/ask";
import { problemOf } from "../api/problem";
import { reachable } from "../api/reachable";
import { ask } from "../api/ask";
import * as state from "./state";

let latest = new AbortController();

async function draw(question: Parameters<typeof reachable>[0], signal: AbortSignal): Promise<void> {
  try {
    const found = await reachable(question, { signal });
    if (!signal.aborted) state.contours.value = found;
  } catch (thrown) {
    if (signal.aborted || isAbort(thrown)) return;
    state.contours.value = [];
    state.problem.value = problemOf(thrown);
  }
}

/** Begins to follow what contours are wanted. */
export function followReach(): void {
  void ask<{ paths: Record<string, unknown> }>("/openapi.json").then(
    ({ paths }) => (state.hasReach.value = "/v1/reachable" in paths),
    () => undefined,
  );
  effect(() => {
    const [map, robot, start] = [state.map.value, state.robot.value, state.start.value];
    latest.abort();
    if (!state.wantsReach.value || !state.hasReach.value || !map || !robot || !start) {
      state.contours.value = [];
      return;
    }
    latest = new AbortController();
    const speed_mps = state.speed_mps.value;
    const question = { map_id: map.id, robot: state.loaded(robot), start, charge: state.charge.value, ...(speed_mps !== null && { speed_mps }) };
    void draw(question, latest.signal);
  });
}
