/** Pictures of the ground in tiles of Web Mercator, laid over the map where the service says that they belong. */
import { computed, signal } from "@preact/signals";
import type { Earth, TileSource } from "../api/earth";
import { between } from "./lattice";
import { toPixel, type Point, type Size, type View } from "./view";

/** Where tiles come from; null where the service was given no such place. */
export const tileSource = signal<TileSource | null>(null);

/** Grows whenever a tile has come or failed. */
const arrivals = signal(0);
/** Tiles that did not come. */
const failed = new Set<string>();
const held = new Map<string, HTMLImageElement>();

/** How many tiles did not come. */
export const missing = computed(() => (arrivals.value, failed.size));

/** Pixels of a tile's edge. */
const TILE_PX = 256;
/** More than a screen of 4000 by 2500 pixels shows. */
const MOST_TILES = 400;
const MOST_HELD = 1000;
/** Errors that nobody sees [px]; a tile is cut in four while the straight lines of its edges are off by more. */
const UNSEEN_PX = 0.25;
const MOST_CUTS = 4;
/** Tiles are drawn so much too large at first, lest the ground shines through between them, and over that as large as they are [px]. */
const PASSES_PX = [1, 0];

interface Tile {
  z: number;
  x: number;
  y: number;
}

const addressOf = ({ url }: TileSource, { z, x, y }: Tile) =>
  url.replaceAll("{z}", String(z)).replaceAll("{x}", String(x)).replaceAll("{y}", String(y));

/** A tile's picture, if it is there; asks for it otherwise. */
function pictureOf(source: TileSource, tile: Tile): HTMLImageElement | null {
  const address = addressOf(source, tile);
  const known = held.get(address);
  if (known) return known.complete && known.naturalWidth > 0 ? known : null;
  const image = new Image();
  // The page tells nobody where it is looked at; who gives tiles may want to know which service it is.
  image.referrerPolicy = "origin";
  image.onload = () => (arrivals.value += 1);
  image.onerror = () => {
    failed.add(address);
    arrivals.value += 1;
  };
  image.src = address;
  held.set(address, image);
  const oldest = held.keys().next().value;
  if (held.size > MOST_HELD && oldest !== undefined) held.delete(oldest);
  return null;
}

/** The tiles that show a map at about a picture's pixel for one of the screen. */
export function tilesOf({ bounds, tiles }: Earth, px_per_m: number, maxZoom: number): Tile[] {
  const [west, north, east, south] = bounds;
  const [left, right] = [between(tiles, [0, 0.5]), between(tiles, [1, 0.5])];
  const worldPx = (Math.hypot(right[0] - left[0], right[1] - left[1]) * px_per_m) / (east - west);
  const wanted = Math.round(Math.log2(worldPx / TILE_PX));
  for (let z = Math.min(Math.max(wanted, 0), maxZoom); ; z--) {
    const count = 2 ** z;
    const first = [Math.floor(west * count), Math.floor(north * count)] as const;
    const last = [Math.min(Math.floor(east * count), count - 1), Math.min(Math.floor(south * count), count - 1)] as const;
    const all: Tile[] = [];
    if (z > 0 && (last[0] - first[0] + 1) * (last[1] - first[1] + 1) > MOST_TILES * 16) continue;
    for (let y = first[1]; y <= last[1]; y++) for (let x = first[0]; x <= last[0]; x++) all.push({ z, x, y });
    return all;
  }
}

/** Where a place of the square of the world lies on the canvas. */
export function onCanvas({ bounds: [west, north, east, south], tiles }: Earth, view: View, size: Size, x: number, y: number): Point {
  const [x_m, y_m] = between(tiles, [(x - west) / (east - west), (y - north) / (south - north)]);
  return toPixel(view, size, x_m, y_m);
}

interface Board {
  context: CanvasRenderingContext2D;
  earth: Earth;
  view: View;
  size: Size;
  /** Pixels of the canvas for one of the page. */
  ratio: number;
}

/** Draws all tiles of a map that are in view. */
export function drawTiles(board: Board, source: TileSource, frame: { x: number; y: number; width: number; height: number }): void {
  void arrivals.value;
  const { context, earth, view } = board;
  context.save();
  context.beginPath();
  context.rect(frame.x, frame.y, frame.width, frame.height);
  context.clip();
  const inView = tilesOf(earth, view.px_per_m, source.max_zoom).filter((tile) => isInView(board, tile));
  const pictures = inView.slice(0, MOST_TILES).map((tile) => ({ tile, picture: pictureOf(source, tile) }));
  for (const over_px of PASSES_PX) {
    for (const { tile, picture } of pictures) if (picture) drawPart({ ...board, over_px }, picture, tile, [0, 0, 1], MOST_CUTS);
  }
  context.restore();
}

/** Corners of a part of a tile on the canvas; the part by its first corner and edge in parts of the tile. */
function cornersOf({ earth, view, size }: Board, { z, x, y }: Tile, [right, down, edge]: [number, number, number]): Point[] {
  const count = 2 ** z;
  return [
    [0, 0],
    [1, 0],
    [0, 1],
    [1, 1],
  ].map(([a, b]) => onCanvas(earth, view, size, (x + right + a! * edge) / count, (y + down + b! * edge) / count));
}

function isInView(board: Board, tile: Tile): boolean {
  const corners = cornersOf(board, tile, [0, 0, 1]);
  const [xs, ys] = [corners.map(({ x }) => x), corners.map(({ y }) => y)];
  return Math.max(...xs) > 0 && Math.min(...xs) < board.size.width && Math.max(...ys) > 0 && Math.min(...ys) < board.size.height;
}

interface Pass extends Board {
  /** How much each part is too large on every side [px]. */
  over_px: number;
}

/** Draws a part of a tile as the parallelogram that is nearest to its corners, or in four parts where that is seen. */
function drawPart(board: Pass, picture: HTMLImageElement, tile: Tile, part: [number, number, number], cuts: number): void {
  const [a, b, c, d] = cornersOf(board, tile, part) as [Point, Point, Point, Point];
  const off = Math.hypot(a.x + d.x - b.x - c.x, a.y + d.y - b.y - c.y) / 4;
  const [right, down, edge] = part;
  if (off > UNSEEN_PX && cuts > 0) {
    const half = edge / 2;
    for (const [i, j] of [
      [0, 0],
      [1, 0],
      [0, 1],
      [1, 1],
    ] as const)
      drawPart(board, picture, tile, [right + i * half, down + j * half, half], cuts - 1);
    return;
  }
  const { context, ratio } = board;
  const [u, v] = [
    { x: (b.x - a.x + d.x - c.x) / 2, y: (b.y - a.y + d.y - c.y) / 2 },
    { x: (c.x - a.x + d.x - b.x) / 2, y: (c.y - a.y + d.y - b.y) / 2 },
  ];
  const middle = { x: (a.x + b.x + c.x + d.x) / 4, y: (a.y + b.y + c.y + d.y) / 4 };
  const first = { x: middle.x - (u.x + v.x) / 2, y: middle.y - (u.y + v.y) / 2 };
  context.setTransform(ratio * u.x, ratio * u.y, ratio * v.x, ratio * v.y, ratio * first.x, ratio * first.y);
  context.imageSmoothingQuality = "high";
  const { naturalWidth: width, naturalHeight: height } = picture;
  const over = board.over_px / Math.max(Math.hypot(u.x, u.y), 1);
  const box = [-over, -over, 1 + 2 * over, 1 + 2 * over] as const;
  context.drawImage(picture, right * width, down * height, edge * width, edge * height, ...box);
}
