/** The question as part of the page's address, so that a link shows the same. */
import { batch, effect } from "@preact/signals";
import type { Place } from "../api/plans";
import * as calibrate from "../calibrate/state";
import { job } from "../diagnose/state";
import { tab, type Tab, TABS } from "../tab";
import { keep } from "./history";
import * as state from "./state";
import * as steering from "./steering";

const number = (text: string | null) => (text !== null && text !== "" && Number.isFinite(Number(text)) ? Number(text) : null);
const rounded = (value: number, places = 3) => String(Number(value.toFixed(places)));

function place(text: string | null): Place | null {
  if (!text) return null;
  const [x_m, y_m, heading_rad] = text.split(",").map(Number);
  if (x_m === undefined || y_m === undefined || !Number.isFinite(x_m) || !Number.isFinite(y_m)) return null;
  return heading_rad !== undefined && Number.isFinite(heading_rad) ? { x_m, y_m, heading_rad } : { x_m, y_m };
}

const written = ({ x_m, y_m, heading_rad }: Place) =>
  [rounded(x_m), rounded(y_m), ...(heading_rad === undefined ? [] : [rounded(heading_rad, 4)])].join(",");

/** Steering that is on or off, by its names in the address. */
const SWITCHES = [
  ["reverse", steering.mayReverse],
  ["no_spin", steering.forbidsSpin],
  ["stops", steering.weighsStops],
  ["partial", steering.isPartial],
  ["either_way", steering.isEitherWay],
] as const;

/** Takes up what the address says. */
export const readLink = () => batch(takeUp);

function takeUp(): void {
  const [name = "", query = ""] = location.hash.slice(1).split("?");
  const said = new URLSearchParams(query);
  tab.value = TABS.includes(name as Tab) ? (name as Tab) : "plan";
  state.mapId.value = said.get("map") ?? state.mapId.value;
  // Links that name a start and no robot were made when the page began with this one.
  state.robotId.value = said.get("robot") ?? (said.has("start") ? "husky-a200" : "husky-a200-field");
  state.formerId.value = said.get("former");
  state.start.value = place(said.get("start"));
  state.goal.value = place(said.get("goal"));
  state.stops.value = (said.get("visit") ?? "").split(";").flatMap((text) => place(text || null) ?? []);
  state.journey.value = said.has("visit") ? "stops" : "goal";
  state.returnsHome.value = said.has("return");
  const range = said.get("range");
  state.rangeKind.value = range === "there" || range === "return" ? range : null;
  state.speed_mps.value = number(said.get("speed_mps"));
  state.payload_kg.value = number(said.get("payload_kg")) ?? 0;
  state.charge.value = number(said.get("charge")) ?? 1;
  state.surface.value = said.get("surface");
  for (const [name, of] of SWITCHES) of.value = said.has(name);
  const least_m = number(said.get("least_radius_m"));
  steering.leastRadius_m.value = least_m !== null && least_m >= 0 ? least_m : null;
  const layer = said.get("layer");
  state.layer.value = layer === "slope" || layer === "surface" ? layer : "elevation";
  state.is3d.value = said.has("3d");
  state.hasTiles.value = said.has("tiles");
  const reach = said.get("reach");
  state.reach.value = reach === "outward" || reach === "homeward" || reach === "out-and-back" ? reach : null;
  if (state.start.value && state.journey.value === "stops") state.tool.value = "stops";
  else if (state.start.value) state.tool.value = state.goal.value ? "move" : "goal";
  for (const [name, of] of [["job", job] as const, ["calibration", calibrate.job] as const]) {
    const id = said.get(name);
    if (id !== (of.value?.id ?? null)) of.value = id ? { id, state: "queued" } : null;
  }
}

function link(): string {
  const said = new URLSearchParams();
  const say = (name: string, value: string | null | undefined) => value && said.set(name, value);
  say("map", state.mapId.value);
  say("robot", state.robotId.value);
  say("former", state.formerId.value);
  say("start", state.start.value && written(state.start.value));
  say("goal", state.goal.value && written(state.goal.value));
  if (state.journey.value === "stops") said.set("visit", state.stops.value.map(written).join(";"));
  if (state.returnsHome.value) said.set("return", "");
  say("range", state.rangeKind.value);
  say("speed_mps", state.speed_mps.value !== null ? rounded(state.speed_mps.value) : null);
  say("payload_kg", state.payload_kg.value ? rounded(state.payload_kg.value) : null);
  say("charge", state.charge.value < 1 ? rounded(state.charge.value) : null);
  say("surface", state.surface.value);
  for (const [name, of] of SWITCHES) if (of.value) said.set(name, "");
  say("least_radius_m", steering.leastRadius_m.value !== null ? rounded(steering.leastRadius_m.value) : null);
  say("layer", state.layer.value === "elevation" ? null : state.layer.value);
  if (state.is3d.value) said.set("3d", "");
  if (state.hasTiles.value) said.set("tiles", "");
  say("reach", state.reach.value);
  say("job", job.value?.id);
  say("calibration", calibrate.job.value?.id);
  const query = said
    .toString()
    .replaceAll("%2C", ",")
    .replaceAll("%3B", ";")
    .replace(/=(?=&|$)/g, "");
  return `#${tab.value}${query ? `?${query}` : ""}`;
}

/** Begins to keep the address as the page is. */
export function keepLink(): void {
  let waiting: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    const now = link();
    // A slider or a place that is held is one change once it is let go.
    if (state.isDragging.value) return;
    // Browsers refuse an address that changes with every step of a slider.
    clearTimeout(waiting);
    waiting = setTimeout(() => (location.hash !== now || history.state === null) && keep(now), 200);
  });
}
