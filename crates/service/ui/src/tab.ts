/** The part of the page that is shown. */
import { signal } from "@preact/signals";

export const TABS = ["plan", "robots", "diagnose"] as const;
export type Tab = (typeof TABS)[number];
export const tab = signal<Tab>("plan");
