/** Drawing, moving, changing and deleting areas, whatever hand does it. */
import { batch } from "@preact/signals";
import { announce } from "../announce";
import type { AreaProperties, Geometry, Position } from "../api/areas";
import { change } from "./changes";
import { inWords, kindOf, withEffect, type Kind } from "./effects";
import * as state from "./state";

/** Corners that a shape needs. */
const leastCorners = () => (state.mode.value === "polygon" ? 3 : 2);

export function addCorner(corner: Position): void {
  state.corners.value = [...state.corners.value, corner];
  const count = state.corners.value.length;
  announce(`Corner ${count}.${count >= leastCorners() ? " Enter at the same place ends the shape." : ""}`);
}

export function takeCornerBack(): void {
  state.corners.value = state.corners.value.slice(0, -1);
  announce(`${state.corners.value.length} corners left.`);
}

/** Leaves what was begun: the shape that is drawn, the drag, or the selection. */
export function giveUp(): void {
  if (state.preview.value) state.preview.value = null;
  else if (state.corners.value.length > 0) state.corners.value = [];
  else state.selected.value = null;
  announce("Given up.");
}

export const canFinish = () => state.corners.value.length >= leastCorners();

/** Ends the shape that is drawn, and stores it. */
export function finish(): void {
  const corners = state.corners.value;
  if (!canFinish()) {
    announce(`A ${state.mode.value} needs ${leastCorners()} corners.`);
    return;
  }
  const isPolygon = state.mode.value === "polygon";
  const geometry: Geometry = isPolygon
    ? { type: "Polygon", coordinates: [[...corners, corners[0] as Position]] }
    : { type: "LineString", coordinates: corners };
  const properties = { [state.nextKind.value]: state.nextValue(state.nextKind.value) };
  const areas = [...state.areas.value, { type: "Feature" as const, properties, geometry }];
  batch(() => {
    state.corners.value = [];
    state.selected.value = areas.length - 1;
    state.mode.value = "select";
    void change(areas, `Area drawn: ${inWords(properties)}.`);
  });
}

/** Puts what is shown while dragging in the place of the selected shape. */
export function drop(): void {
  const [geometry, selected] = [state.preview.value, state.selected.value];
  if (!geometry || selected === null) return;
  batch(() => {
    state.preview.value = null;
    void change(
      state.areas.value.map((area, i) => (i === selected ? { ...area, geometry } : area)),
      "Area moved.",
    );
  });
}

/** Gives an effect to the selected area, or else to the next. */
export function setEffect(kind: Kind, value: AreaProperties[Kind]): void {
  const selected = state.selected.value;
  const area = state.selectedArea.value;
  if (selected === null || !area) {
    state.nextKind.value = kind;
    state.nextValues.value = { ...state.nextValues.value, [kind]: value };
    return;
  }
  const properties = withEffect(area.properties, kind, value);
  void change(
    state.areas.value.map((each, i) => (i === selected ? { ...each, properties } : each)),
    `Area changed: ${inWords(properties)}.`,
  );
}

export function removeSelected(): void {
  const [selected, area] = [state.selected.value, state.selectedArea.value];
  if (selected === null || !area) return;
  batch(() => {
    state.selected.value = null;
    void change(
      state.areas.value.filter((_, i) => i !== selected),
      `Area deleted: ${inWords(area.properties)}.`,
    );
  });
}

export function select(index: number | null): void {
  state.selected.value = index;
  const area = state.selectedArea.value;
  if (area) announce(`Area ${(index ?? 0) + 1} selected: ${inWords(area.properties)}.`);
}

export function setMode(mode: state.Mode): void {
  batch(() => {
    state.mode.value = mode;
    state.corners.value = [];
    state.preview.value = null;
    if (mode !== "select") state.selected.value = null;
  });
}

/** The kind that the fields show. */
export const shownKind = () => (state.selectedArea.value ? kindOf(state.selectedArea.value.properties) : state.nextKind.value);
