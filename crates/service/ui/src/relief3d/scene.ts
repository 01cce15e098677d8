/** The ground as a mesh with its picture on it, areas on that, paths above, and the robot. Fetched only when wanted. */
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  CatmullRomCurve3,
  ConeGeometry,
  DirectionalLight,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  TubeGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Cells } from "../api/maps";
import type { Pose } from "../api/plans";
import { STYLE } from "../map/draw";
import type { Backdrop, ShownPath } from "../plan/shown_paths";
import { discardPicture, newCloth, paint, type Painting } from "./cloth";
import { addOverlays, clearOverlays, type Ground, type Overlays } from "./overlays";

/** Most cells along a side of the mesh. */
const MESH_SIDE = 400;

export interface Shown {
  ground: (cells: Cells, picture: HTMLCanvasElement, stretch: number, tint: string) => void;
  paths: (backdrops: Backdrop[], followed: ShownPath[], color: (name: string) => string) => void;
  areas: (painting: Painting) => void;
  overlays: (shown: Overlays, z_m: Ground["z_m"], color: (name: string) => string) => void;
  robot: (pose: Pose | null) => void;
  end: () => void;
}

/** Shows a scene in an element; null where the browser has no WebGL. */
export function showRelief(element: HTMLElement): Shown | null {
  let renderer: WebGLRenderer;
  try {
    renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  } catch {
    return null;
  }
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  element.append(renderer.domElement);
  const scene = new Scene();
  scene.add(new AmbientLight(0xffffff, 2.2));
  const lamp = new DirectionalLight(0xffffff, 1.6);
  lamp.position.set(-1, 1.4, -1);
  scene.add(lamp);
  const camera = new PerspectiveCamera(40, 1, 0.01, 100);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.maxPolarAngle = 0.49 * Math.PI;
  const draw = () => renderer.render(scene, camera);
  controls.addEventListener("change", draw);

  const resize = () => {
    renderer.setSize(element.clientWidth, element.clientHeight);
    camera.aspect = element.clientWidth / Math.max(element.clientHeight, 1);
    camera.updateProjectionMatrix();
    draw();
  };
  const watcher = new ResizeObserver(resize);
  watcher.observe(element);

  /** From map metres to the scene, in which the longer side of the map is 2. */
  let toScene = (_x_m: number, _y_m: number, _z_m: number) => new Vector3();
  let isPlaced = false;
  const terrain = new Group();
  const cloth = newCloth();
  const lines = new Group();
  const overlays = new Group();
  const robot = new Mesh(new ConeGeometry(0.028, 0.08, 4), new MeshLambertMaterial({ color: 0xffb000 }));
  robot.visible = false;
  scene.add(terrain, cloth, lines, overlays, robot);

  return {
    ground(cells, picture, stretch, tint) {
      const { toScene: next, geometry } = meshOf(cells, stretch);
      toScene = next;
      clear(terrain);
      cloth.geometry = geometry;
      const texture = new CanvasTexture(picture);
      texture.colorSpace = SRGBColorSpace;
      texture.anisotropy = renderer.capabilities.getMaxAnisotropy();
      terrain.add(new Mesh(geometry, new MeshBasicMaterial({ map: texture, color: tint })));
      if (!isPlaced) {
        camera.position.set(-0.86, 1.45, 2.08);
        controls.target.set(0, 0, 0.1);
        controls.update();
        isPlaced = true;
      }
      draw();
    },
    paths(backdrops, followed, color) {
      clear(lines);
      const add = ({ poses, style }: Backdrop, radius: number) => {
        const points = thinned(poses).map((p) => toScene(p.x_m, p.y_m, p.z_m).add(new Vector3(0, 0.008, 0)));
        if (points.length < 2) return;
        const tube = new TubeGeometry(new CatmullRomCurve3(points), points.length * 3, radius, 6);
        lines.add(new Mesh(tube, new MeshBasicMaterial({ color: color(STYLE[style].color) })));
      };
      for (const path of backdrops) add(path, 0.004);
      followed.forEach((path, i) => add(path, i === followed.length - 1 ? 0.008 : 0.0045));
      draw();
    },
    areas(painting) {
      paint(cloth, painting, renderer.capabilities.getMaxAnisotropy());
      draw();
    },
    overlays(shown, z_m, color) {
      clearOverlays(overlays);
      addOverlays(overlays, shown, { z_m, toScene }, color);
      draw();
    },
    robot(pose) {
      robot.visible = pose !== null;
      if (pose) {
        robot.position.copy(toScene(pose.x_m, pose.y_m, pose.z_m)).add(new Vector3(0, 0.02, 0));
        robot.rotation.set(0, pose.heading_rad, 0);
        robot.rotateZ(-Math.PI / 2);
      }
      draw();
    },
    end() {
      watcher.disconnect();
      controls.dispose();
      clear(terrain);
      discardPicture(cloth);
      cloth.material.dispose();
      clear(lines);
      clearOverlays(overlays);
      renderer.dispose();
      renderer.domElement.remove();
    },
  };
}

function clear(group: Group): void {
  for (const child of [...group.children]) {
    if (child instanceof Mesh) {
      child.geometry.dispose();
      (child.material as MeshBasicMaterial).map?.dispose();
      (child.material as MeshBasicMaterial).dispose();
    }
    group.remove(child);
  }
}

/** Every so many poses: a tube needs no more. */
const thinned = (poses: Backdrop["poses"]) => poses.filter((_, i) => i % Math.ceil(poses.length / 300) === 0 || i === poses.length - 1);

function meshOf(cells: Cells, stretch: number) {
  const { rows, columns, cell_size_m, x_m, y_m, z_m } = cells;
  const step = Math.ceil(Math.max(rows, columns) / MESH_SIDE);
  const [wide, high] = [Math.ceil(columns / step), Math.ceil(rows / step)];
  const scale = 2 / (Math.max(rows, columns) * cell_size_m);
  let [least, greatest] = [Infinity, -Infinity];
  for (const z of z_m) {
    if (z < least) least = z;
    if (z > greatest) greatest = z;
  }
  const middle_m = (least + greatest) / 2;
  const [east_m, north_m] = [x_m + (columns * cell_size_m) / 2, y_m + (rows * cell_size_m) / 2];
  const toScene = (x: number, y: number, z: number) =>
    new Vector3((x - east_m) * scale, (z - middle_m) * scale * stretch, -(y - north_m) * scale);

  const position = new Float32Array(3 * wide * high);
  const uv = new Float32Array(2 * wide * high);
  for (let i = 0; i < wide * high; i++) {
    const row = Math.min(Math.floor(i / wide) * step, rows - 1);
    const column = Math.min((i % wide) * step, columns - 1);
    const z = z_m[row * columns + column]!;
    const at = toScene(x_m + (column + 0.5) * cell_size_m, y_m + (row + 0.5) * cell_size_m, Number.isNaN(z) ? least : z);
    position.set([at.x, at.y, at.z], 3 * i);
    uv.set([(column + 0.5) / columns, (row + 0.5) / rows], 2 * i);
  }
  const faces: number[] = [];
  for (let row = 0; row + 1 < high; row++) {
    for (let column = 0; column + 1 < wide; column++) {
      const a = row * wide + column;
      faces.push(a, a + 1, a + wide, a + 1, a + wide + 1, a + wide);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("uv", new BufferAttribute(uv, 2));
  geometry.setIndex(faces);
  return { geometry, toScene };
}
