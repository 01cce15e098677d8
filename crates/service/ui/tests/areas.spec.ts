import type { Page, TestInfo } from "@playwright/test";
import { answered, checkAccessible, energyOf, expect, openSample, paths, picture, pixel, test, type Service, PHONE_TOO } from "./service";

interface Comparison {
  energy: { energy_j: number; distance_m: number; poses: { x_m: number; y_m: number }[] };
}

/** Sets corners with a finger on a phone, else with the mouse, and ends the shape as is usual there. */
async function draw(page: Page, info: TestInfo, places: [number, number][], aspect = 1): Promise<void> {
  await paths(page).scrollIntoViewIfNeeded();
  for (const [i, place] of places.entries()) {
    const [x, y] = await pixel(page, place, aspect);
    if (info.project.name === "phone") await page.touchscreen.tap(x, y);
    else if (i === places.length - 1) await page.mouse.dblclick(x, y);
    else await page.mouse.click(x, y);
  }
  if (info.project.name === "phone") await page.getByRole("button", { name: "Finish" }).click();
}

/** The next answer of paths that are compared. */
async function planned(page: Page): Promise<Comparison> {
  const response = await page.waitForResponse((each) => each.url().endsWith("/v1/compare") && each.ok());
  return (await response.json()) as Comparison;
}

/** The areas of the map that the page shows. */
async function stored(page: Page, service: Service): Promise<{ features: { properties: object; geometry: { coordinates: unknown } }[] }> {
  const id = /map=([0-9a-f]+)/.exec(page.url())?.[1];
  return (await page.request.get(`${service.url}/v1/maps/${id}/areas?frame=map`)).json();
}

/** A wall across the sample's path from its start to its goal. */
const WALL: [number, number][] = [
  [0.2, 0.74],
  [0.74, 0.2],
  [0.83, 0.29],
  [0.29, 0.83],
];

const openTools = (page: Page) => page.getByRole("button", { name: "Areas", exact: true }).click();

test("a keep-out that is drawn leads the path around it, and undo brings the old one back", PHONE_TOO, async ({ page, service }, info) => {
  const first = planned(page);
  await openSample(page, service);
  const before = await first;
  const shown = await energyOf(page, "Energy-minimal");
  await openTools(page);
  const around = planned(page);
  await draw(page, info, WALL);
  const after = await around;
  expect(after.energy.poses).not.toEqual(before.energy.poses);
  expect(after.energy.energy_j).toBeGreaterThan(before.energy.energy_j + 1);
  await expect.poll(() => energyOf(page, "Energy-minimal")).toBeGreaterThan(shown);
  await expect(page.locator(".areas-legend")).toContainText("Keep out");
  await picture(page, `areas-${info.project.name}`);
  await checkAccessible(page, "areas");
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(() => energyOf(page, "Energy-minimal")).toBeCloseTo(shown, 5);
  await expect(page.locator(".areas-legend")).toHaveCount(0);
  await page.getByRole("button", { name: "Redo" }).click();
  await expect.poll(() => energyOf(page, "Energy-minimal")).toBeGreaterThan(shown);
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(1);
});

test("an area is selected, dragged, changed and deleted", async ({ page, service }, info) => {
  await openSample(page, service);
  await openTools(page);
  await draw(page, info, [
    [0.1, 0.6],
    [0.3, 0.6],
    [0.3, 0.8],
    [0.1, 0.8],
  ]);
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(1);
  const corners = async () => (await stored(page, service)).features[0]!.geometry.coordinates as [number, number][][];
  const drawn = (await corners())[0]!;
  const drag = async (from: [number, number], to: [number, number]) => {
    await page.mouse.move(...(await pixel(page, from, 1)));
    await page.mouse.down();
    await page.mouse.move(...(await pixel(page, to, 1)), { steps: 4 });
    await page.mouse.up();
  };
  await drag([0.2, 0.7], [0.3, 0.7]);
  await expect.poll(async () => (await corners())[0]![0]![0]).toBeGreaterThan(drawn[0]![0] + 30);
  expect((await corners())[0]![0]![1]).toBeCloseTo(drawn[0]![1], 1);
  const moved = (await corners())[0]!;
  await drag([0.4, 0.8], [0.45, 0.9]);
  await expect.poll(async () => (await corners())[0]![2]![1]).toBeGreaterThan(moved[2]![1] + 30);
  expect((await corners())[0]![0]).toEqual(moved[0]);
  await page.getByLabel("Effect of the area").selectOption("One way");
  await expect.poll(async () => (await stored(page, service)).features[0]!.properties).toEqual({ one_way_rad: 0 });
  await page.getByLabel("Direction").fill("90");
  await page.getByLabel("Direction").press("Enter");
  await expect.poll(async () => (await stored(page, service)).features[0]!.properties).toEqual({ one_way_rad: Math.PI / 2 });
  await page.getByRole("button", { name: "Delete" }).click();
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(0);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(1);
  await page.keyboard.press("Control+Shift+Z");
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(0);
});

test("an area that crosses itself is refused in words, and not kept", async ({ page, service }, info) => {
  await openSample(page, service);
  await openTools(page);
  await draw(page, info, [
    [0.2, 0.4],
    [0.4, 0.7],
    [0.4, 0.4],
    [0.2, 0.7],
  ]);
  await expect(page.getByRole("alert")).toContainText("crosses itself");
  await expect(page.locator(".areas-legend")).toHaveCount(0);
  await expect(page.getByRole("button", { name: "Undo" })).toBeDisabled();
  await page.getByRole("button", { name: "Close" }).click();
  await expect(page.getByRole("alert")).toHaveCount(0);
  await answered(page);
});

test("areas of every kind are read from a file, told apart, and saved to one", async ({ page, service }, info) => {
  await openSample(page, service);
  await expect.poll(() => page.url()).toMatch(/map=/);
  await openTools(page);
  const square = (west: number, south: number, properties: object) => ({
    type: "Feature",
    properties,
    geometry: {
      type: "Polygon",
      coordinates: [[0, 1, 2, 3, 0].map((i) => [west + (i === 1 || i === 2 ? 40 : 0), south + (i > 1 ? 40 : 0)])],
    },
  });
  const mapId = /map=([0-9a-f]+)/.exec(page.url())![1];
  const summaries = (await (await page.request.get(`${service.url}/v1/maps`)).json()) as {
    maps: { id: string; origin_m: [number, number] }[];
  };
  const [west, south] = summaries.maps.find((map) => map.id === mapId)!.origin_m;
  const kinds = [{ keep_out: true }, { surface: "sandy_loam" }, { max_speed_mps: 0.4 }, { cost_factor: 3 }, { one_way_rad: Math.PI / 4 }];
  const document = {
    type: "FeatureCollection",
    crs: null,
    features: kinds.map((properties, i) => square(west + 60 + 55 * i, south + 250 + 12 * i, properties)),
  };
  const open = page.locator(".area-files input[type=file]");
  await open.setInputFiles({ name: "yard.geojson", mimeType: "application/geo+json", buffer: Buffer.from(JSON.stringify(document)) });
  for (const name of ["Keep out", "Surface", "Speed limit", "Cost factor", "One way"]) {
    await expect(page.locator(".areas-legend")).toContainText(name);
  }
  await answered(page);
  await paths(page).scrollIntoViewIfNeeded();
  await picture(page, `areas-kinds-${info.project.name}`);
  const saving = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save file" }).click();
  const saved = await saving;
  expect(saved.suggestedFilename()).toBe("areas.geojson");
  const { readFileSync } = process.getBuiltinModule("node:fs");
  expect(JSON.parse(readFileSync((await saved.path())!, "utf8"))).toEqual(document);
  await open.setInputFiles({ name: "wrong.geojson", mimeType: "application/geo+json", buffer: Buffer.from("{") });
  await expect(page.getByRole("alert")).toContainText(/wrong\.geojson is no JSON/i);
  await expect(page.locator(".areas-legend")).toContainText("Keep out");
});

test("an area is drawn and moved by keys alone", async ({ page, service }) => {
  await service.storeMap("maps/yard.json", "application/json");
  await page.goto(service.url);
  await openTools(page);
  const map = page.getByRole("application", { name: /Map/ });
  await map.focus();
  const keys = async (...names: string[]) => {
    for (const name of names) await page.keyboard.press(name);
  };
  await keys("Enter", "Shift+ArrowRight", "Enter", "Shift+ArrowUp", "Enter", "Enter");
  await expect(page.locator("p[role=status]")).toHaveText("Area drawn: keep out.");
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(1);
  const first = async () => ((await stored(page, service)).features[0]!.geometry.coordinates as [number, number][][])[0]![0]!;
  const before = await first();
  // The cursor stands on the last corner: one step back along the edge is on the area, and no corner.
  await keys("ArrowDown", "ArrowDown", "ArrowDown", "Enter", "Shift+ArrowLeft", "Enter");
  await expect(page.locator("p[role=status]")).toHaveText("Area moved.");
  await expect.poll(async () => (await first())[0]).toBeLessThan(before[0] - 0.5);
  await keys("Delete");
  await expect.poll(async () => (await stored(page, service)).features.length).toBe(0);
});

test("options are sent where they are chosen, and are part of the link", async ({ page, service, context }) => {
  const first = page.waitForRequest((request) => request.url().endsWith("/v1/compare"));
  await openSample(page, service);
  const usual = (await first).postDataJSON() as object;
  for (const name of ["reverse", "forbid", "least_radius_m", "prices", "partial"]) expect(usual).not.toHaveProperty(name);
  await page.locator(".steering summary").click();
  await page.getByLabel("Allow reversing").check();
  await page.getByLabel("Weigh stops").check();
  await page.getByLabel("No turns on the spot").check();
  const asked = page.waitForRequest(
    (request) => request.url().endsWith("/v1/compare") && (request.postDataJSON() as { least_radius_m?: number }).least_radius_m === 1.5,
  );
  await page.getByLabel("Least turning radius").fill("1.5");
  await page.getByLabel("Least turning radius").press("Enter");
  expect((await asked).postDataJSON()).toMatchObject({ reverse: true, forbid: ["spin"], prices: { stops: true }, least_radius_m: 1.5 });
  await expect(page.locator(".steering summary")).toHaveText("Options (4 chosen)");
  await expect.poll(() => page.url()).toContain("least_radius_m=1.5");
  const second = await context.newPage();
  const again = second.waitForRequest((request) => request.url().endsWith("/v1/compare"));
  await second.goto(page.url());
  expect((await again).postDataJSON()).toMatchObject({ reverse: true, forbid: ["spin"], prices: { stops: true }, least_radius_m: 1.5 });
});

test("a partial path is shown where nothing leads to the goal", async ({ page, service }, info) => {
  await openSample(page, service);
  await page.locator(".steering summary").click();
  await page.getByLabel("Partial path").check();
  await openTools(page);
  // From edge to edge of the map, between start and goal.
  await draw(page, info, [
    [0.4, 0.001],
    [0.45, 0.001],
    [0.45, 0.999],
    [0.4, 0.999],
  ]);
  await expect(page.locator(".short-of-goal")).toContainText("short of it");
});
