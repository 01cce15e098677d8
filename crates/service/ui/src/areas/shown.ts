/** The areas that the map and the 3-D view show. */
import { computed } from "@preact/signals";
import type { Area, Position } from "../api/areas";
import type { Kind } from "./effects";
import * as state from "./state";

export interface ShownAreas {
  areas: Area[];
  /** The index of the one that is being edited. */
  selected: number | null;
}

/** A shape that is being drawn. */
export interface Draft {
  corners: Position[];
  kind: Kind;
}

/** The areas of the map, one that is dragged where it is dragged to. */
export const shownAreas = computed<ShownAreas>(() => {
  const [selected, preview] = [state.selected.value, state.preview.value];
  const areas = state.areas.value.map((area, i) => (preview && i === selected ? { ...area, geometry: preview } : area));
  return { areas, selected: state.isEditing.value ? selected : null };
});

export const shownDraft = computed<Draft | null>(() => {
  const [corners, kind] = [state.corners.value, state.nextKind.value];
  return state.isEditing.value && corners.length > 0 ? { corners, kind } : null;
});
