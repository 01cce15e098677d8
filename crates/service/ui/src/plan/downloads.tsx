/** The focused path or the mission as a file, and a link to all of this. */
import { signal } from "@preact/signals";
import { announce } from "../announce";
import { send } from "../api/ask";
import { problemOf } from "../api/problem";
import { missionQuestion } from "./mission";
import { question } from "./replan";
import * as state from "./state";

const FORMS = [
  { name: "JSON", type: "application/json", ending: "json", about: "All of the answer" },
  {
    name: "GeoJSON",
    type: "application/geo+json",
    ending: "geojson",
    about: "The line in longitude and latitude, or in metres where the map does not say where on earth it lies",
  },
  {
    name: "GPX",
    type: "application/gpx+xml",
    ending: "gpx",
    about: "Tracks; the start is put at 0° N 0° E where the map does not say where on earth it lies",
  },
  {
    name: "KML",
    type: "application/vnd.google-earth.kml+xml",
    ending: "kml",
    about: "Lines on the globe, of a map that says where on earth it lies",
  },
  { name: "CSV", type: "text/csv", ending: "csv", about: "Pose by pose" },
] as const;

const isCopied = signal(false);

export function saveFile(text: Blob, name: string): void {
  const address = URL.createObjectURL(text);
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  link.click();
  URL.revokeObjectURL(address);
}

/** What a file is asked of, and called; null while something is missing. */
function asked(): { path: string; json: object; name: string } | null {
  if (state.journey.value === "stops") {
    const mission = missionQuestion();
    return mission && { path: "/v1/mission", json: mission, name: "mission" };
  }
  const objective = state.focus.value;
  const path = question();
  return path && { path: "/v1/plan", json: { ...path, objective }, name: `path-${objective}` };
}

async function download({ type, ending }: (typeof FORMS)[number]): Promise<void> {
  const now = asked();
  if (!now) return;
  const name = `${now.name}.${ending}`;
  // The document of a mission is at hand, and takes longest to be found anew.
  const atHand =
    state.journey.value === "stops" && ending === "json" ? new Blob([JSON.stringify(state.mission.value, null, 2)], { type }) : null;
  try {
    saveFile(atHand ?? (await (await send(now.path, { json: now.json, accept: type })).blob()), name);
    announce(`${name} is downloaded.`);
  } catch (thrown) {
    state.problem.value = problemOf(thrown);
  }
}

async function copyLink(): Promise<void> {
  try {
    await navigator.clipboard.writeText(location.href);
    isCopied.value = true;
    announce("The link is copied.");
    setTimeout(() => (isCopied.value = false), 2000);
  } catch {
    announce("The browser does not let this page copy: the link is in its address bar.");
  }
}

export function Downloads() {
  const isMission = state.journey.value === "stops";
  const isReady = (isMission ? state.mission : state.comparison).value !== null;
  return (
    <section class="downloads" aria-label="Take it with you">
      <div class="choice" role="group" aria-label={isMission ? "Download the mission" : "Download the path"}>
        {FORMS.map((form) => (
          <button key={form.name} type="button" title={form.about} disabled={!isReady} onClick={() => void download(form)}>
            {form.name}
          </button>
        ))}
      </div>
      <LinkButton />
    </section>
  );
}

function LinkButton() {
  return (
    <button type="button" onClick={() => void copyLink()}>
      {isCopied.value ? "Copied" : "Copy link"}
    </button>
  );
}
