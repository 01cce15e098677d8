import {
  answered,
  colors,
  energyOf,
  expect,
  fittedWidth,
  ground,
  openSample,
  paths,
  picture,
  press,
  repositoryFile,
  test,
  PHONE_TOO,
} from "./service";

test("the sample map is drawn and its three paths are compared at once", PHONE_TOO, async ({ page, service }, info) => {
  const outside: string[] = [];
  page.on(
    "request",
    (request) => request.url().startsWith(service.url) || request.url().startsWith("blob:") || outside.push(request.url()),
  );
  const complaints: string[] = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await openSample(page, service, "husky-a200-field");
  expect(await colors(ground(page))).toBeGreaterThan(500);
  expect(await colors(paths(page))).toBeGreaterThan(20);
  const [least, shortest] = [await energyOf(page, "Energy-minimal"), await energyOf(page, "Shortest")];
  expect(least).toBeGreaterThan(10);
  expect(least).toBeLessThan(0.98 * shortest);
  const saved = Number.parseInt(await page.locator(".answer-saving").innerText());
  expect(Math.abs(saved - 100 * (1 - least / shortest))).toBeLessThan(1);
  await picture(page, `plan-${info.project.name}`);
  const beyond = await page.evaluate(() => document.documentElement.scrollHeight - innerHeight);
  if (info.project.name === "desktop") expect(beyond, "the side scrolls, not the page").toBeLessThanOrEqual(0);
  await expect(page.getByRole("link", { name: /guide$/i }).filter({ visible: true })).toHaveAttribute("href", "/docs/guide/");
  expect(outside, "nothing is asked of anyone else").toEqual([]);
  expect(complaints).toEqual([]);
});

test("on a phone no control and no reading lies over the map, and so over none of its ends", PHONE_TOO, async ({ page, service }, info) => {
  test.skip(info.project.name !== "phone", "wider screens have room beside the map");
  await openSample(page, service, "husky-a200-field");
  await page.getByRole("button", { name: "Goal", exact: true }).click();
  await press(page, 0.6, 0.6);
  await expect(page.locator(".map-steps")).toBeVisible();
  const frame = (await page.locator(".map-frame").boundingBox())!;
  await page.mouse.move(frame.x + frame.width / 2, frame.y + frame.height / 2);
  await expect(page.locator(".map-coordinates")).toBeVisible();
  // The sample is square and fills what the rows above and below it leave.
  const side = fittedWidth(frame);
  const map = { top: frame.y + (frame.height - side) / 2, bottom: frame.y + (frame.height + side) / 2 };
  for (const name of [".map-coordinates", ".north-arrow", ".map-zoom", ".map-legends", ".map-steps", ".scale-bar"]) {
    const box = (await page.locator(name).boundingBox())!;
    expect(box.y + box.height <= map.top + 1 || box.y >= map.bottom - 1, `${name} is beside the map`).toBe(true);
    expect(box.x >= frame.x && box.x + box.width <= frame.x + frame.width, `${name} is within the frame`).toBe(true);
  }
  const [north, readout] = [(await page.locator(".north-arrow").boundingBox())!, (await page.locator(".map-coordinates").boundingBox())!];
  expect(readout.x + readout.width, "the readings lie beside one another").toBeLessThanOrEqual(north.x);
  await picture(page, "phone-readings");
});

test("the first picture of a stored map comes without being asked for", async ({ page, service }) => {
  await service.storeMap("maps/minnesota.tif", "image/tiff");
  const begun = performance.now();
  await page.goto(service.url, { waitUntil: "commit" });
  await page.waitForFunction(() => {
    const canvas = document.querySelector<HTMLCanvasElement>(".map-ground");
    return (canvas?.getContext("2d")?.getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data[3] ?? 0) > 0;
  });
  console.log(`    first picture after ${Math.round(performance.now() - begun)} ms`);
});

test("a map that is dropped is shown, and start and goal are what is pressed", PHONE_TOO, async ({ page, service }) => {
  await page.goto(service.url);
  await page.locator(".first-map input[type=file]").setInputFiles(repositoryFile("maps/yard.json"));
  await expect(page.getByText("Where to?")).toBeVisible();
  await expect.poll(() => colors(ground(page))).toBeGreaterThan(100);
  await press(page, 0.25, 0.4);
  await expect(page.getByText("Now click where it is to go.")).toBeVisible();
  await press(page, 0.8, 0.6);
  await answered(page);
  expect(await energyOf(page, "Energy-minimal")).toBeLessThanOrEqual(await energyOf(page, "Shortest"));
  await page.getByRole("button", { name: "Surface" }).click();
  await expect(page.getByText("sandy loam").first()).toBeVisible();
});

test("a slider that is dragged plans anew, more payload takes more energy, and too little charge is said", async ({ page, service }) => {
  await openSample(page, service);
  const before = await energyOf(page, "Energy-minimal");
  const slider = page.getByRole("slider", { name: "Payload" });
  await expect(slider).toHaveAccessibleDescription(/^0\skg to 72\skg$/);
  await expect(page.getByRole("slider", { name: "Speed" })).toHaveAccessibleDescription(/^0\.10\sm\/s to 1\.00\sm\/s$/);
  await slider.scrollIntoViewIfNeeded();
  const box = (await slider.boundingBox())!;
  const y = box.y + box.height / 2;
  const asked = page.waitForRequest((request) => request.url().endsWith("/v1/compare") && request.postDataJSON().bound > 1);
  await page.mouse.move(box.x + 10, y);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.3 * box.width, y, { steps: 4 });
  await asked;
  await page.mouse.move(box.x + 0.6 * box.width, y, { steps: 4 });
  await page.mouse.up();
  await answered(page);
  await expect(page.getByText(/Proven: no path of the planner's lattice takes less than .*Freed from the lattice/)).toBeVisible();
  expect(await energyOf(page, "Energy-minimal")).toBeGreaterThan(1.2 * before);
  await slider.press("Home");
  await expect.poll(() => energyOf(page, "Energy-minimal")).toBeCloseTo(before, 5);
  await expect(page.locator(".charge")).toHaveAttribute("data-fine", "true");
  await page.getByRole("slider", { name: "Charge" }).press("Home");
  await expect(page.getByText(/Below the reserve/)).toBeVisible();
});

test("pointing at a chart moves the robot on the map, and pointing at the path moves the charts", async ({ page, service }) => {
  await openSample(page, service);
  const before = await paths(page).screenshot();
  await page
    .locator(".u-over")
    .nth(2)
    .hover({ position: { x: 200, y: 40 } });
  await expect(page.locator(".chart-card b").nth(3)).toHaveText(/kJ/);
  expect((await paths(page).screenshot()).equals(before)).toBe(false);
  const power = await page.locator(".chart-card b").nth(2).innerText();
  const box = (await paths(page).boundingBox())!;
  const side = fittedWidth(box);
  // Close to the goal, where the path ends.
  await page.mouse.move(box.x + box.width / 2 + (0.9 - 0.5) * side - 16, box.y + box.height / 2 - (0.88 - 0.5) * side);
  await expect(page.locator(".chart-card b").nth(2)).not.toHaveText(power);
});

test("the slope layer and the third dimension are drawn", PHONE_TOO, async ({ page, service }, info) => {
  await openSample(page, service, "husky-a200-field");
  await page.getByRole("button", { name: "Slope" }).click();
  await expect(page.locator(".legend")).toContainText("≥");
  await page.getByRole("button", { name: "3-D" }).click();
  const canvas = page.locator(".relief-3d canvas");
  await expect.poll(() => colors(canvas)).toBeGreaterThan(200);
  await page.getByRole("button", { name: "Elevation" }).click();
  await page.getByRole("slider", { name: "Along the path" }).fill("200");
  await page.getByRole("button", { name: "Switch to dark colours" }).click();
  await picture(page, `relief-${info.project.name}`);
});

test("the link shows the same again", async ({ page, service, context }) => {
  await openSample(page, service);
  await page.getByRole("slider", { name: "Speed" }).press("End");
  await answered(page);
  await expect.poll(() => page.url()).toContain("speed_mps=1");
  const before = await energyOf(page, "Energy-minimal");
  const second = await context.newPage();
  await second.goto(page.url());
  await answered(second);
  expect(await energyOf(second, "Energy-minimal")).toBe(before);
});

test("the path is saved in every form", async ({ page, service }) => {
  await openSample(page, service);
  for (const [form, ending, begins] of [
    ["JSON", "json", "{"],
    ["GeoJSON", "geojson", "{"],
    ["GPX", "gpx", "<?xml"],
    ["KML", "kml", "<?xml"],
    ["CSV", "csv", "x_m,y_m,z_m"],
  ] as const) {
    const saving = page.waitForEvent("download");
    await page.getByRole("button", { name: form, exact: true }).click();
    const saved = await saving;
    expect(saved.suggestedFilename()).toBe(`path-energy.${ending}`);
    const { readFileSync } = process.getBuiltinModule("node:fs");
    const text = readFileSync((await saved.path())!, "utf8");
    expect(text.startsWith(begins), form).toBe(true);
    if (form === "KML") expect(text, "of a map that lies on earth").toMatch(/<coordinates>-93\.92\d+,46\.50\d+,\d/);
  }
});
