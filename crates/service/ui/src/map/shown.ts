/** What of the map is shown, and in how much room. */
import { signal } from "@preact/signals";
import type { Size, View } from "./view";

export const view = signal<View | null>(null);
export const size = signal<Size>({ width: 0, height: 0 });
