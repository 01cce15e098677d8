/** What stands or lies on the ground of the 3-D view besides paths: marked places, what is written on areas, and contours of energy. */
import {
  BufferGeometry,
  CanvasTexture,
  Group,
  Line,
  LineBasicMaterial,
  LinearFilter,
  LineLoop,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
  Vector3,
} from "three";
import type { Contour } from "../api/reachable";
import { LABEL_PX, setLabelStyle, writeLabel, type Label } from "../areas/label";
import type { Marker } from "../map/markers";
import { between } from "../map/reach_ramp";

export interface Ground {
  /** Elevation [m]; NaN off known ground. */
  z_m: (x_m: number, y_m: number) => number;
  toScene: (x_m: number, y_m: number, z_m: number) => Vector3;
}

export interface Overlays {
  markers: Marker[];
  labels: Label[];
  contours: Contour[];
}

type Color = (name: string) => string;

/** Side of a marker's picture [px], and of the marker on the screen at any distance, for the camera's field of view at a distance of one. */
const PICTURE_PX = 96;
const MARKER_SIZE = 0.045;
/** Height of a marker's staff in the scene. */
const STAFF = 0.09;
/** Height of a label on the screen, as of markers, and pixels of its picture for one of its text. */
const LABEL_SIZE = 0.036;
const LABEL_RATIO = 2;
/** Contours lie so far above the ground that it does not hide them. */
const ABOVE_GROUND = 0.006;

/** A disc with a letter, as on the map. */
function disc(letter: string, color: Color): CanvasTexture {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [PICTURE_PX, PICTURE_PX];
  const context = canvas.getContext("2d");
  const [ink, paper] = letter === "S" ? [color("casing"), color("end-ink")] : [color("end-ink"), color("casing")];
  if (context) {
    const half = PICTURE_PX / 2;
    context.beginPath();
    context.arc(half, half, half - 8, 0, 2 * Math.PI);
    context.fillStyle = paper;
    context.fill();
    context.lineWidth = 8;
    context.strokeStyle = ink;
    context.stroke();
    context.fillStyle = ink;
    context.font = `600 ${half}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(letter, half, half + 2);
  }
  return textureOf(canvas);
}

/** A label as it is written on the map. */
function written(label: Label, color: Color): CanvasTexture {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  if (context) {
    setLabelStyle(context);
    const width = context.measureText(label.words).width + context.lineWidth;
    [canvas.width, canvas.height] = [Math.ceil(width * LABEL_RATIO), LABEL_PX * LABEL_RATIO];
    context.scale(LABEL_RATIO, LABEL_RATIO);
    writeLabel(context, label, color, width / 2, LABEL_PX / 2);
  }
  const texture = textureOf(canvas);
  // Small letters stay sharp: they are shown at about half of their picture's size or more.
  texture.generateMipmaps = false;
  texture.minFilter = LinearFilter;
  return texture;
}

function textureOf(canvas: HTMLCanvasElement): CanvasTexture {
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

/** A picture that faces who looks, as large from everywhere, and seen through hills. */
const spriteOf = (map: CanvasTexture) => new Sprite(new SpriteMaterial({ map, depthTest: false, sizeAttenuation: false }));

/** Fills a group with what stands and lies on the ground. */
export function addOverlays(group: Group, { markers, labels, contours }: Overlays, ground: Ground, color: Color): void {
  addContours(group, contours, ground, color);
  addLabels(group, labels, ground, color);
  addMarkers(group, markers, ground, color);
}

/** Each place on a staff that stands on the ground. */
function addMarkers(group: Group, markers: Marker[], { z_m, toScene }: Ground, color: Color): void {
  for (const { place, letter } of markers) {
    const height_m = z_m(place.x_m, place.y_m);
    if (Number.isNaN(height_m)) continue;
    const foot = toScene(place.x_m, place.y_m, height_m);
    const head = foot.clone().add(new Vector3(0, STAFF, 0));
    group.add(new Line(new BufferGeometry().setFromPoints([foot, head]), new LineBasicMaterial({ color: color("end-ink") })));
    const sprite = spriteOf(disc(letter, color));
    sprite.position.copy(head);
    sprite.scale.setScalar(MARKER_SIZE);
    // Over what is written on areas, wherever that is seen from.
    sprite.renderOrder = 1;
    group.add(sprite);
  }
}

/** What each area changes, upright over its middle. */
function addLabels(group: Group, labels: Label[], { z_m, toScene }: Ground, color: Color): void {
  for (const label of labels) {
    const height_m = z_m(...label.at);
    if (Number.isNaN(height_m)) continue;
    const map = written(label, color);
    const sprite = spriteOf(map);
    sprite.position.copy(toScene(...label.at, height_m));
    sprite.center.y = 0;
    sprite.scale.set((LABEL_SIZE * map.image.width) / map.image.height, LABEL_SIZE, 1);
    group.add(sprite);
  }
}

/** Contours along the ground, in the colours of their legend. */
function addContours(group: Group, contours: Contour[], { z_m, toScene }: Ground, color: Color): void {
  for (const [i, { polygons }] of contours.entries()) {
    const material = new LineBasicMaterial({ color: between(color, i, contours.length) });
    for (const ring of polygons.flat()) {
      let before_m = NaN;
      const points = ring.flatMap(([x_m, y_m]) => {
        const height_m = z_m(x_m, y_m);
        if (!Number.isNaN(height_m)) before_m = height_m;
        return Number.isNaN(before_m) ? [] : [toScene(x_m, y_m, before_m).add(new Vector3(0, ABOVE_GROUND, 0))];
      });
      if (points.length > 1) group.add(new LineLoop(new BufferGeometry().setFromPoints(points), material));
    }
  }
}

/** Empties a group of them. */
export function clearOverlays(group: Group): void {
  for (const child of [...group.children]) {
    if (child instanceof Line) {
      child.geometry.dispose();
      (child.material as LineBasicMaterial).dispose();
    } else if (child instanceof Sprite) {
      child.material.map?.dispose();
      child.material.dispose();
    }
    group.remove(child);
  }
}
