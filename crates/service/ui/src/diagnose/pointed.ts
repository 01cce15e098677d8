/** The moment of a drive that the report's charts and its map point at together. */
import { signal } from "@preact/signals";

export const pointed = signal<{ run: number; t_s: number } | null>(null);
