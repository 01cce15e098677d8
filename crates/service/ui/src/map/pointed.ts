/** What the pointer is at. */
import { signal } from "@preact/signals";
import type { Place } from "../api/plans";

/** The place under the pointer; null while it is not on the map, or the keyboard's cursor was moved since. */
export const pointedAt = signal<Place | null>(null);
