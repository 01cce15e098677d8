/** Areas in the view in three dimensions, on a slope that rises to the east. */
import type { Page } from "@playwright/test";
import { PerspectiveCamera, Vector3 } from "three";
import { colors, expect, ground, pixel, test, type Service } from "./service";

const SIDE_M = 60;
const SLOPE = 0.2;

type Rgb = [number, number, number];
/** Colours of the style sheet, in light. */
const KEEP_OUT: Rgb = [0xb0, 0x12, 0x3c];
const SPEED: Rgb = [0x8a, 0x52, 0x00];

interface Place {
  x_m: number;
  y_m: number;
}

/** An area and a place in it, away from what is written in its middle. */
function square(west: number, south: number, properties: object) {
  const corners = [0, 1, 2, 3, 0].map((i) => [west + (i === 1 || i === 2 ? 12 : 0), south + (i > 1 ? 12 : 0)]);
  const feature = { type: "Feature", properties, geometry: { type: "Polygon", coordinates: [corners] } };
  return { feature, place: { x_m: west + 3, y_m: south + 3 } };
}

const HIGH = square(44, 8, { keep_out: true });
const LOW = square(6, 36, { max_speed_mps: 0.4 });
const FILE = {
  name: "yard.geojson",
  mimeType: "application/geo+json",
  buffer: Buffer.from(JSON.stringify({ type: "FeatureCollection", crs: null, features: [HIGH.feature, LOW.feature] })),
};

async function openSlope(page: Page, service: Service): Promise<void> {
  const row = Array.from({ length: SIDE_M }, (_, i) => SLOPE * i);
  const data = { cell_size_m: 1, rows: SIDE_M, columns: SIDE_M, elevation_m: row.map(() => row) };
  expect((await page.request.post(`${service.url}/v1/maps`, { data })).ok()).toBe(true);
  await page.emulateMedia({ colorScheme: "light" });
  await page.goto(service.url);
  await page.getByRole("button", { name: "Areas", exact: true }).click();
}

const toggle3d = (page: Page) => page.getByRole("button", { name: "3-D" }).click();

/** Where a place is seen as the view opens, by shares of the canvas from its upper left. */
function seenAt({ x_m, y_m }: Place, stretch: number, aspect: number): { right: number; down: number } {
  const camera = new PerspectiveCamera(40, aspect);
  camera.position.set(-0.86, 1.45, 2.08);
  camera.lookAt(0, 0, 0.1);
  camera.updateMatrixWorld();
  const half_m = SIDE_M / 2;
  const up_m = SLOPE * (x_m - half_m) * stretch;
  const at = new Vector3((x_m - half_m) / half_m, up_m / half_m, -(y_m - half_m) / half_m).project(camera);
  return { right: (1 + at.x) / 2, down: (1 - at.y) / 2 };
}

/** How far the pixels about a place are from a colour, the nearest of them; 441 is farthest. */
async function distanceTo(page: Page, color: Rgb, place: Place, stretch: number): Promise<number> {
  const canvas = page.locator(".relief-3d canvas");
  const box = (await canvas.boundingBox())!;
  const at = seenAt(place, stretch, box.width / box.height);
  const around = await canvas.evaluate((element: HTMLCanvasElement, { right, down }) => {
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [element.width, element.height];
    const context = copy.getContext("2d")!;
    context.drawImage(element, 0, 0);
    const size = Math.round(0.03 * copy.height);
    return [...context.getImageData(right * copy.width - size / 2, down * copy.height - size / 2, size, size).data];
  }, at);
  const distances = Array.from({ length: around.length / 4 }, (_, i) => Math.hypot(...color.map((c, k) => c - around[4 * i + k]!)));
  return Math.min(...distances);
}

/** Colours nearer than this are the same behind a rim and smoothed edges; bare ground is farther than twice as much off either. */
const NEAR = 75;

/** Which of both areas are seen where they lie: the high one, the low one. */
const seen = async (page: Page, stretch: number) => [
  (await distanceTo(page, KEEP_OUT, HIGH.place, stretch)) < NEAR,
  (await distanceTo(page, SPEED, LOW.place, stretch)) < NEAR,
];

test("areas lie on the ground in three dimensions, follow its heights, and go and come with undo and redo", async ({ page, service }) => {
  await openSlope(page, service);
  await toggle3d(page);
  await expect.poll(() => colors(page.locator(".relief-3d canvas"))).toBeGreaterThan(20);
  expect(await seen(page, 2)).toEqual([false, false]);
  await page.locator(".area-files input[type=file]").setInputFiles(FILE);
  await expect.poll(() => seen(page, 2)).toEqual([true, true]);
  await expect(page.locator(".relief-3d .areas-legend")).toHaveText(/Keep out.*Speed limit/);
  expect(await seen(page, 6), "where heights have not brought them yet").toEqual([false, false]);
  await page.getByRole("slider", { name: "Heights" }).fill("6");
  await expect.poll(() => seen(page, 6)).toEqual([true, true]);
  expect(await seen(page, 2), "where they lay before").toEqual([false, false]);
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(() => seen(page, 6)).toEqual([false, false]);
  await page.getByRole("button", { name: "Redo" }).click();
  await expect.poll(() => seen(page, 6)).toEqual([true, true]);
});

test("a shape that is begun on the map is seen in three dimensions", async ({ page, service }) => {
  await openSlope(page, service);
  const onEdge = { x_m: 0.35 * SIDE_M, y_m: 0.7 * SIDE_M };
  await toggle3d(page);
  await expect.poll(() => colors(page.locator(".relief-3d canvas"))).toBeGreaterThan(20);
  expect(await distanceTo(page, KEEP_OUT, onEdge, 2)).toBeGreaterThan(2 * NEAR);
  await toggle3d(page);
  // A canvas has 300 pixels until the map knows its size, and takes clicks from then on.
  await expect.poll(() => ground(page).evaluate((canvas: HTMLCanvasElement) => canvas.width)).toBeGreaterThan(300);
  for (const right of [0.2, 0.5]) await page.mouse.click(...(await pixel(page, [right, 0.7])));
  await expect(page.locator("p[role=status]")).toHaveText(/^Corner 2\./);
  await toggle3d(page);
  await expect.poll(() => distanceTo(page, KEEP_OUT, onEdge, 2)).toBeLessThan(NEAR);
});
