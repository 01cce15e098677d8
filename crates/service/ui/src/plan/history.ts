/** Undo by the browser's history: every change of the question is a step back. */
import { signal } from "@preact/signals";

/** Changes of the same part of the address that come sooner than this are one step, as a slider's [ms]. */
const ONE_STEP_MS = 1500;

let changedLast = "";
let changedAt_ms = -Infinity;

interface Step {
  /** How many steps this page has made before. */
  depth: number;
}

const depthOf = (state: unknown) => (state as Step | null)?.depth ?? 0;

/** Whether there is a step of this page to go back to. */
export const canUndo = signal(false);
/** Whether there is one to go forward to. */
export const canRedo = signal(false);
let deepest = 0;

function noticed(): void {
  const depth = depthOf(history.state);
  deepest = Math.max(deepest, depth);
  canUndo.value = depth > 0;
  canRedo.value = depth < deepest;
}

/** Names of the parts in which two addresses differ. */
export function changes(before: string, after: string): string {
  const parts = (hash: string) => {
    const [name = "", query = ""] = hash.replace(/^#/, "").split("?");
    return new Map([["tab", name], ...new URLSearchParams(query)]);
  };
  const [a, b] = [parts(before), parts(after)];
  return [...new Set([...a.keys(), ...b.keys()])].filter((name) => a.get(name) !== b.get(name)).join(" ");
}

/** Makes an address the page's own, as a step that can be undone; the first one of a page replaces what was typed. */
export function keep(hash: string): void {
  const changed = changes(location.hash, hash);
  const now_ms = performance.now();
  const isSame = changed === changedLast && now_ms - changedAt_ms < ONE_STEP_MS;
  // A page without a map has nothing to come back to.
  const isFirst = history.state === null || !location.hash.includes("map=");
  [changedLast, changedAt_ms] = [changed, now_ms];
  if (isFirst || isSame) history.replaceState({ depth: depthOf(history.state) }, "", hash);
  else {
    deepest = depthOf(history.state) + 1;
    history.pushState({ depth: deepest }, "", hash);
  }
  noticed();
}

export const undo = () => canUndo.value && history.back();
export const redo = () => canRedo.value && history.forward();

/** Begins to listen for Ctrl+Z and Ctrl+Shift+Z wherever no text is typed; areas have steps of their own while they are drawn. */
export function listenForUndo(isElsewhere: () => boolean): void {
  addEventListener("keydown", (event) => {
    const isText = event.target instanceof HTMLInputElement && ["text", "password"].includes(event.target.type);
    const key = event.key.toLowerCase();
    if (isText || isElsewhere() || !(event.ctrlKey || event.metaKey) || event.altKey || (key !== "z" && key !== "y")) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) redo();
    else undo();
  });
}

addEventListener("popstate", () => {
  changedLast = "";
  noticed();
});
