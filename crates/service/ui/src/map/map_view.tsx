/** The map: ground below, paths and ends above, for mouse, fingers and keys. */
import { effect, signal, useComputed } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Cells } from "../api/maps";
import { DraftButtons } from "../areas/draft_buttons";
import { canFinish } from "../areas/edit";
import { drawAreas, drawDraft } from "../areas/draw";
import { AREA_KEYS } from "../areas/keys";
import { labelsOf, writeLabel } from "../areas/label";
import { AreasLegend } from "../areas/legend";
import { shownAreas, shownDraft } from "../areas/shown";
import * as areas from "../areas/state";
import { backdrops, focusedPath, followedPaths } from "../plan/shown_paths";
import * as state from "../plan/state";
import { color, theme } from "../theme";
import { poseAt } from "./along";
import { drawContours, drawCrosshair, drawEnd, drawPaths, drawRobot, type Scene } from "./draw";
import { markers } from "./markers";
import { drawMeasure } from "./draw_measure";
import { measured, points } from "../plan/measure";
import { ReachLegend } from "./reach_legend";
import { cursor } from "./cursor";
import { Coordinates } from "./coordinates";
import { earth } from "./earth";
import { listen } from "./gestures";
import { KEYS, press } from "./keys";
import { Legend } from "./legend";
import { NorthArrow } from "./north_arrow";
import { pointedAt } from "./pointed";
import { relief, scaleOf, slopesOf } from "./relief";
import { Steps } from "./steps";
import { ScaleBar } from "./scale_bar";
import { size, view } from "./shown";
import { drawTiles, missing, tileSource } from "./tiles";
import { extentOf, fitted, toPixel, zoomed, type View } from "./view";

/** The picture of the ground with what its colours mean. */
const ground = signal<{ picture: HTMLCanvasElement; least: number; greatest: number } | null>(null);

let drawn: { cells: Cells; slopes: ReturnType<typeof slopesOf> } | null = null;

/** Draws the ground anew when the map or the layer changes. */
effect(() => {
  const [cells, layer] = [state.cells.value, state.layer.value];
  if (!cells) {
    ground.value = null;
    return;
  }
  if (drawn?.cells !== cells) drawn = { cells, slopes: slopesOf(cells) };
  const scale = scaleOf(cells, drawn.slopes, layer);
  ground.value = { picture: relief(cells, drawn.slopes, layer, scale), ...scale };
});

/** The picture of the ground, for the view in three dimensions. */
export const groundPicture = () => ground.value?.picture ?? null;

function sized(canvas: HTMLCanvasElement): CanvasRenderingContext2D | null {
  const ratio = devicePixelRatio || 1;
  const { width, height } = size.value;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context?.setTransform(ratio, 0, 0, ratio, 0, 0);
  context?.clearRect(0, 0, width, height);
  return context;
}

function drawGround(canvas: HTMLCanvasElement): void {
  const [shown, cells, picture] = [view.value, state.cells.value, ground.value?.picture];
  const context = sized(canvas);
  if (!context || !shown || !cells || !picture) return;
  const west = toPixel(shown, size.value, cells.x_m, cells.y_m + cells.rows * cells.cell_size_m);
  const px = cells.cell_size_m * shown.px_per_m;
  // Single cells are shown as they are once they are large enough to be seen.
  context.imageSmoothingEnabled = px < 12;
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, west.x, west.y, cells.columns * px, cells.rows * px);
}

function drawPictures(canvas: HTMLCanvasElement): void {
  const [shown, known, source, map] = [view.value, earth.value, tileSource.value, state.map.value];
  const context = sized(canvas);
  if (!context || !shown || !known || !source || !map || !state.hasTiles.value) return;
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  const corner = toPixel(shown, size.value, west_m, south_m + height_m);
  const frame = { ...corner, width: width_m * shown.px_per_m, height: height_m * shown.px_per_m };
  drawTiles({ context, earth: known, view: shown, size: size.value, ratio: devicePixelRatio || 1 }, source, frame);
}

function drawOver(canvas: HTMLCanvasElement): void {
  const context = sized(canvas);
  const [shown, followed] = [view.value, focusedPath.value];
  void theme.value;
  if (!context || !shown) return;
  const scene: Scene = { context, view: shown, size: size.value, color };
  drawAreas(scene, shownAreas.value);
  for (const label of labelsOf(shownAreas.value.areas)) {
    const { x, y } = toPixel(shown, size.value, ...label.at);
    writeLabel(context, label, color, x, y);
  }
  drawContours(scene, state.contours.value);
  drawPaths(scene, backdrops.value, followedPaths.value);
  for (const { place, letter } of markers.value) drawEnd(scene, place, letter);
  const pose = followed && state.along_m.value !== null ? poseAt(followed.poses, state.along_m.value) : null;
  if (pose) drawRobot(scene, pose);
  if (shownDraft.value) drawDraft(scene, shownDraft.value, cursor.value ?? pointedAt.value);
  if (state.tool.value === "measure") drawMeasure(scene, points.value, cursor.value ?? pointedAt.value);
  if (cursor.value) drawCrosshair(scene, cursor.value);
}

/** Shows the whole of a map when another one is chosen. */
function followFit(): () => void {
  let fittedFor = "";
  let fittedAs: View | null = null;
  return effect(() => {
    const [map, { width, height }] = [state.map.value, size.value];
    if (!map || width === 0) return;
    // A map with other areas is the same ground: the view stays.
    const key = `${Object.values(extentOf(map))} ${Math.round(width / 40)} ${Math.round(height / 40)}`;
    // A view that nobody has moved fits whatever room there is.
    if (key === fittedFor && view.peek() !== fittedAs) return;
    fittedFor = key;
    view.value = fittedAs = fitted(map, { width, height });
  });
}

/** What a click does while areas are edited. */
function areaHint(): string {
  if (areas.mode.value === "select") return areas.selected.value === null ? "Click an area to select it" : "Drag the area or its corners";
  const count = areas.corners.value.length;
  if (count === 0) return `Click the corners of a ${areas.mode.value}`;
  return canFinish() ? "Double-click or Enter ends the shape" : "Click the next corner";
}

/** Whom the tiles are from, and how many did not come. */
function Attribution() {
  const source = tileSource.value;
  if (!source || !state.hasTiles.value || !earth.value) return null;
  const gaps = missing.value > 0 ? ` (${missing.value} tiles did not come)` : "";
  return <p class="map-attribution">{`${source.attribution}${gaps}`.trim() || "Tiles without a stated source"}</p>;
}

export function MapView() {
  const frame = useRef<HTMLDivElement>(null);
  const below = useRef<HTMLCanvasElement>(null);
  const pictures = useRef<HTMLCanvasElement>(null);
  const above = useRef<HTMLCanvasElement>(null);

  useEffect(() => {
    const [element, groundCanvas, tileCanvas, overCanvas] = [frame.current, below.current, pictures.current, above.current];
    if (!element || !groundCanvas || !tileCanvas || !overCanvas) return;
    const ended = new AbortController();
    const watcher = new ResizeObserver(() => (size.value = { width: element.clientWidth, height: element.clientHeight }));
    watcher.observe(element);
    listen({ element: overCanvas, size: () => size.value, view: () => view.value, show: (next) => (view.value = next) }, ended.signal);
    const draw = [() => drawGround(groundCanvas), () => drawPictures(tileCanvas), () => drawOver(overCanvas)];
    const stops = [...draw.map((each) => effect(each)), followFit()];
    return () => {
      ended.abort();
      watcher.disconnect();
      for (const stop of stops) stop();
    };
  }, []);

  const hint = useComputed(() => {
    if (state.tool.value === "areas") return areaHint();
    if (state.tool.value === "measure") return measured.value;
    if (state.tool.value === "start") return "Click where the robot starts; drag to set its heading";
    if (state.tool.value === "stops") return state.stops.value.length === 0 ? "Click each place to visit" : "";
    return state.tool.value === "goal" ? "Click where it is to go" : "";
  });
  const onKey = (event: KeyboardEvent) => {
    if (view.value && press(event, view.value, size.value, (next) => (view.value = next))) event.preventDefault();
  };
  const zoom = (factor: number) => () => {
    const [shown, map] = [view.value, state.map.value];
    if (shown && map) view.value = zoomed(shown, size.value, { x: size.value.width / 2, y: size.value.height / 2 }, factor, map);
  };
  const fit = () => {
    if (state.map.value) view.value = fitted(state.map.value, size.value);
  };

  return (
    <div class="map" data-tool={areas.isEditing.value && areas.mode.value === "select" ? "move" : state.tool.value}>
      <div
        ref={frame}
        class="map-frame"
        tabIndex={0}
        role="application"
        aria-roledescription="map"
        aria-label="Map of the ground with the paths"
        aria-describedby="map-keys"
        onKeyDown={onKey}
        onBlur={() => (cursor.value = null)}
      >
        <canvas ref={below} class="map-ground" aria-hidden="true" />
        <canvas ref={pictures} class="map-tiles" aria-hidden="true" />
        <canvas ref={above} class="map-over" aria-hidden="true" />
      </div>
      <p id="map-keys" class="map-keys">
        {areas.isEditing.value ? AREA_KEYS : KEYS}
      </p>
      {hint.value && <p class="map-hint">{hint}</p>}
      <Steps />
      <DraftButtons />
      <div class="map-zoom" role="group" aria-label="Zoom">
        <button type="button" aria-label="Zoom in" title="Zoom in" onClick={zoom(1.5)}>
          +
        </button>
        <button type="button" aria-label="Zoom out" title="Zoom out" onClick={zoom(1 / 1.5)}>
          −
        </button>
        <button type="button" aria-label="Show the whole map" title="Show the whole map" onClick={fit}>
          ⤢
        </button>
      </div>
      {state.map.value && <NorthArrow />}
      <div class="map-foot">
        <div class="map-legends">
          <AreasLegend />
          <ReachLegend />
          {ground.value && <Legend least={ground.value.least} greatest={ground.value.greatest} />}
        </div>
        <div class="map-where">
          <Coordinates />
          <Attribution />
        </div>
        {view.value && <ScaleBar view={view.value} />}
      </div>
    </div>
  );
}
