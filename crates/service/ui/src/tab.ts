/** The part of the page that is shown. */
import { effect, signal } from "@preact/signals";

export const TABS = ["plan", "robots", "calibrate", "diagnose"] as const;
export type Tab = (typeof TABS)[number];
export const tab = signal<Tab>("plan");

export const TAB_NAMES: Record<Tab, string> = { plan: "Plan", robots: "Robots", calibrate: "Calibrate", diagnose: "Diagnose" };

effect(() => {
  document.title = `${TAB_NAMES[tab.value]} · joulepath`;
});
