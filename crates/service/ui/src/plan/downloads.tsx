/** The focused path as a file, and a link to all of this. */
import { signal } from "@preact/signals";
import { announce } from "../announce";
import { send } from "../api/ask";
import { problemOf } from "../api/problem";
import { question } from "./replan";
import * as state from "./state";

const FORMS = [
  { name: "JSON", type: "application/json", ending: "json", about: "Everything that is known of the path" },
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
    about: "A track; its start is put at 0° N 0° E where the map does not say where on earth it lies",
  },
  {
    name: "KML",
    type: "application/vnd.google-earth.kml+xml",
    ending: "kml",
    about: "A line on the globe, of a map that says where on earth it lies",
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

async function download({ type, ending }: (typeof FORMS)[number]): Promise<void> {
  const asked = question();
  if (!asked) return;
  const objective = state.focus.value;
  try {
    const response = await send("/v1/plan", { json: { ...asked, objective }, accept: type });
    saveFile(await response.blob(), `path-${objective}.${ending}`);
    announce(`path-${objective}.${ending} is downloaded.`);
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

/** The whole answer of the service; the ways of its stops among it. */
function saveMission(): void {
  const text = JSON.stringify(state.mission.value, null, 2);
  saveFile(new Blob([text], { type: "application/json" }), "mission.json");
  announce("mission.json is downloaded.");
}

export function Downloads() {
  if (state.journey.value === "stops") {
    return (
      <section class="downloads" aria-label="Take it with you">
        <button type="button" disabled={state.mission.value === null} title="Stops, ways and charges" onClick={saveMission}>
          Mission as JSON
        </button>
        <LinkButton />
      </section>
    );
  }
  const isReady = state.comparison.value !== null;
  return (
    <section class="downloads" aria-label="Take it with you">
      <div class="choice" role="group" aria-label="Download the path">
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
