/** The keyboard's cursor on the map. */
import { signal } from "@preact/signals";
import type { Place } from "../api/plans";

/** Where it is; null while the map has not the focus. */
export const cursor = signal<Place | null>(null);
