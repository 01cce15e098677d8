/** Areas lie on the ground of the 3-D view as a cloth over all of it, painted by what paints the map from above. */
import {
  BufferGeometry,
  CanvasTexture,
  CustomBlending,
  Mesh,
  MeshBasicMaterial,
  OneFactor,
  OneMinusSrcAlphaFactor,
  SRGBColorSpace,
} from "three";
import type { Cells } from "../api/maps";
import { drawAreas, drawDraft } from "../areas/draw";
import type { Draft, ShownAreas } from "../areas/shown";

/** Longer side of the map in what areas are drawn with [px]: their lines are about as wide beside paths as on the map from above. */
const SIDE_PX = 400;
/** Longer side of the picture [px]: lines stay sharp to who comes closer. */
const PICTURE_PX = 2048;

export type Cloth = Mesh<BufferGeometry, MeshBasicMaterial>;

/** A cloth that nothing is painted on; it lies on the ground once it has the ground's geometry. */
export function newCloth(): Cloth {
  const material = new MeshBasicMaterial({
    transparent: true,
    depthWrite: false,
    // Colours come multiplied by their share: between the rim of a line and nothing there is no dark seam.
    blending: CustomBlending,
    blendSrc: OneFactor,
    blendDst: OneMinusSrcAlphaFactor,
  });
  const cloth = new Mesh(new BufferGeometry(), material);
  // Markers and labels, which are seen through hills, are seen through areas too.
  cloth.renderOrder = -1;
  cloth.visible = false;
  return cloth;
}

export interface Painting {
  cells: Cells;
  shown: ShownAreas;
  draft: Draft | null;
  color: (name: string) => string;
}

/** Puts areas in the place of those that were on a cloth. */
export function paint(cloth: Cloth, painting: Painting, anisotropy: number): void {
  discardPicture(cloth);
  cloth.visible = painting.shown.areas.length > 0 || painting.draft !== null;
  if (!cloth.visible) return;
  const texture = new CanvasTexture(pictureOf(painting));
  texture.colorSpace = SRGBColorSpace;
  texture.premultiplyAlpha = true;
  texture.anisotropy = anisotropy;
  cloth.material.map = texture;
  cloth.material.needsUpdate = true;
}

/** Lets go of what is painted. */
export function discardPicture(cloth: Cloth): void {
  cloth.material.map?.dispose();
  cloth.material.map = null;
}

/** The whole of a map from above, with nothing but areas on it. */
function pictureOf({ cells, shown, draft, color }: Painting): HTMLCanvasElement {
  const { rows, columns, cell_size_m, x_m, y_m } = cells;
  const [width_m, height_m] = [columns * cell_size_m, rows * cell_size_m];
  const px_per_m = SIDE_PX / Math.max(width_m, height_m);
  const size = { width: width_m * px_per_m, height: height_m * px_per_m };
  const canvas = document.createElement("canvas");
  const ratio = PICTURE_PX / SIDE_PX;
  [canvas.width, canvas.height] = [Math.ceil(size.width * ratio), Math.ceil(size.height * ratio)];
  const context = canvas.getContext("2d");
  if (!context) return canvas;
  context.setTransform(canvas.width / size.width, 0, 0, canvas.height / size.height, 0, 0);
  const scene = { context, view: { x_m: x_m + width_m / 2, y_m: y_m + height_m / 2, px_per_m }, size, color };
  drawAreas(scene, shown);
  if (draft) drawDraft(scene, draft, null);
  return canvas;
}
