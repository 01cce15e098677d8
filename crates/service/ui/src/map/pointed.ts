/** What the pointer is at. */
import { computed, signal } from "@preact/signals";
import type { Place } from "../api/plans";
import { size, view } from "./shown";
import { toMetres, type Point } from "./view";

/** Where the pointer is on the canvas; null while it is not, or the keyboard's cursor was moved since. */
export const pointer = signal<Point | null>(null);

/** The place under the pointer. A pointer that rests is at another place when the view moves, or a map comes, under it. */
export const pointedAt = computed<Place | null>(() =>
  pointer.value && view.value ? toMetres(view.value, size.value, pointer.value) : null,
);
