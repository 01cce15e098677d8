/** The view in three dimensions; what draws it is fetched when it is first wanted. */
import { effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { labelsOf } from "../areas/label";
import { AreasLegend } from "../areas/legend";
import { shownAreas, shownDraft } from "../areas/shown";
import { Progress } from "../widgets/progress";
import { groundPicture } from "../map/map_view";
import { poseAt } from "../map/along";
import { elevationAt } from "../map/ends";
import { markers } from "../map/markers";
import { color, theme } from "../theme";
import { backdrops, focusedPath, followedPaths } from "./shown_paths";
import * as state from "./state";

const stretch = signal(2);
const status = signal<"fetching" | "shown" | "impossible">("fetching");

export function Relief3d() {
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = place.current;
    if (!element) return;
    status.value = "fetching";
    let isOver = false;
    let clear = () => {};
    import("../relief3d/scene").then(
      ({ showRelief }) => {
        if (isOver) return;
        const shown = showRelief(element);
        if (!shown) {
          status.value = "impossible";
          return;
        }
        status.value = "shown";
        const stops = [
          effect(() => {
            void [state.layer.value, theme.value];
            const [cells, picture] = [state.cells.value, groundPicture()];
            if (cells && picture) shown.ground(cells, picture, stretch.value, color("relief-tint"));
          }),
          effect(() => {
            void [theme.value, stretch.value, state.cells.value];
            shown.paths(backdrops.value, followedPaths.value, color);
          }),
          effect(() => {
            void theme.value;
            const cells = state.cells.value;
            if (cells) shown.areas({ cells, shown: shownAreas.value, draft: shownDraft.value, color });
          }),
          effect(() => {
            void [theme.value, stretch.value];
            const cells = state.cells.value;
            const labels = labelsOf(shownAreas.value.areas);
            const overlays = { markers: markers.value, labels, contours: state.contours.value };
            shown.overlays(overlays, (x_m, y_m) => elevationAt(cells, x_m, y_m), color);
          }),
          effect(() => {
            void stretch.value;
            const plan = focusedPath.value;
            shown.robot(plan && state.along_m.value !== null ? poseAt(plan.poses, state.along_m.value) : null);
          }),
        ];
        clear = () => {
          for (const stop of stops) stop();
          shown.end();
        };
      },
      () => (status.value = "impossible"),
    );
    return () => {
      isOver = true;
      clear();
    };
  }, []);
  return (
    <div class="map relief-3d">
      <div
        ref={place}
        class="map-frame"
        role="img"
        aria-label="The ground, areas and paths in three dimensions; drag to turn, scroll to zoom"
      />
      {status.value === "fetching" && <Progress label="Fetching the 3-D view" share={null} />}
      {status.value === "impossible" && (
        <p class="map-hint" role="alert">
          This browser cannot draw in three dimensions (WebGL is off). The map shows the same from above.
        </p>
      )}
      <AreasLegend />
      <label class="relief-stretch">
        Heights × {stretch.value}
        <input
          type="range"
          min={1}
          max={6}
          step={0.5}
          value={stretch.value}
          onInput={(event) => (stretch.value = event.currentTarget.valueAsNumber)}
        />
      </label>
    </div>
  );
}
