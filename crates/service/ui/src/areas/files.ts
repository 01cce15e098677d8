/** Areas from a GeoJSON file, and to one. */
import { announce } from "../announce";
import { documentOf } from "../api/areas";
import { problemOf } from "../api/problem";
import { saveFile } from "../plan/downloads";
import { takeDocument } from "./changes";
import * as state from "./state";

/** Puts the areas of a file in the place of those that there are. */
export async function openFile(file: File): Promise<void> {
  let document: unknown;
  try {
    document = JSON.parse(await file.text());
  } catch (thrown) {
    const why = thrown instanceof Error ? thrown.message : String(thrown);
    state.problem.value = problemOf(new Error(`${file.name} is no JSON: ${why}. Give a GeoJSON feature collection of polygons and lines.`));
    return;
  }
  await takeDocument(document, ({ length }) => `${length} areas of ${file.name} are on the map. Undo brings the former ones back.`);
}

/** Saves the areas in the map's metres. */
export function saveAreas(): void {
  const text = `${JSON.stringify(documentOf(state.areas.value), null, 1)}\n`;
  saveFile(new Blob([text], { type: "application/geo+json" }), "areas.geojson");
  announce("areas.geojson is downloaded.");
}
