/** Which map, how it is drawn, and what a click on it does. */
import { metres } from "../format";
import type { MapSummary } from "../api/maps";
import type { ReachKind } from "../api/reachable";
import { earth } from "../map/earth";
import { tileSource } from "../map/tiles";
import { Choice } from "../widgets/choice";
import { MAP_ENDINGS } from "./first_map";
import { addMap, addSample, chooseMap, SAMPLE_NAME } from "./load";
import { ReadingOptions } from "./reading_options";
import * as state from "./state";

/** What a map is called, and how large it is; one without a name has its id. */
function title({ id, name, rows, columns, cell_size_m, elevation_range_m: [low, high], areas }: MapSummary): string {
  const over = areas > 0 ? `, ${areas} ${areas === 1 ? "area" : "areas"}` : "";
  const extent = `${metres(columns * cell_size_m)} × ${metres(rows * cell_size_m)}, ${metres(high - low)} relief${over}`;
  return name ? `${name} · ${extent}` : `${extent} · ${id.slice(0, 6)}`;
}

/** The choice of the sample map, which is no map's id. */
const SAMPLE = "sample";

export function MapBar() {
  const hasSurfaces = (state.map.value?.surfaces.length ?? 0) > 0;
  return (
    <div class="map-bar">
      <label class="field map-choice">
        <span class="unseen">Map</span>
        <select
          value={state.mapId.value ?? ""}
          onChange={(event) => (event.currentTarget.value === SAMPLE ? void addSample() : chooseMap(event.currentTarget.value))}
        >
          {state.maps.value?.map((map) => (
            <option key={map.id} value={map.id}>
              {title(map)}
            </option>
          ))}
          {!state.maps.value?.some(({ name }) => name === SAMPLE_NAME) && <option value={SAMPLE}>Sample map of Minnesota</option>}
        </select>
      </label>
      <label class="button file">
        <input
          type="file"
          accept={MAP_ENDINGS}
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file) void addMap(file);
            event.currentTarget.value = "";
          }}
        />
        Add map…
      </label>
      <ReadingOptions />
      <Choice
        label="A click sets"
        value={state.tool.value}
        choose={(tool) => (state.tool.value = tool)}
        options={[
          { value: "start", name: "Start" },
          state.journey.value === "stops" ? { value: "stops", name: "Stop" } : { value: "goal", name: "Goal" },
          { value: "move", name: "Move" },
          { value: "areas", name: "Areas" },
          { value: "measure", name: "Measure" },
        ]}
      />
      <Choice
        label="Layer"
        value={state.layer.value}
        choose={(layer) => (state.layer.value = layer)}
        options={[
          { value: "elevation", name: "Elevation" },
          { value: "slope", name: "Slope" },
          ...(hasSurfaces ? [{ value: "surface" as const, name: "Surface" }] : []),
        ]}
      />
      {state.hasReach.value && (
        <select
          aria-label="Contours of energy"
          value={state.reach.value ?? ""}
          onChange={(event) => (state.reach.value = (event.currentTarget.value as ReachKind) || null)}
        >
          <option value="">No contours</option>
          <option value="outward">Reach from start</option>
          <option value="homeward">Reach to start</option>
          <option value="out-and-back">Reach and back</option>
        </select>
      )}
      {tileSource.value && earth.value && (
        <button type="button" aria-pressed={state.hasTiles.value} onClick={() => (state.hasTiles.value = !state.hasTiles.value)}>
          Tiles
        </button>
      )}
      <button type="button" aria-pressed={state.is3d.value} onClick={() => (state.is3d.value = !state.is3d.value)}>
        3-D
      </button>
    </div>
  );
}
