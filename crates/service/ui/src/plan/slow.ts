/** Whether an answer has been awaited for so long that the page should say so. */
import { effect, signal } from "@preact/signals";
import { isPlanning } from "./state";

const PATIENCE_MS = 400;

export const followsAnswer = signal(false);

let waiting: ReturnType<typeof setTimeout> | undefined;
effect(() => {
  clearTimeout(waiting);
  if (isPlanning.value) waiting = setTimeout(() => (followsAnswer.value = true), PATIENCE_MS);
  else followsAnswer.value = false;
});
