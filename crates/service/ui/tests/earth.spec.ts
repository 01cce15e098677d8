import { checkAccessible, expect, fittedWidth, paths, picture, repositoryFile, Service, test, PHONE_TOO } from "./service";
import { serveTiles } from "./tile_server";

/** Places of the sample map, 12 m from its corners: x and y of EPSG:26915, and longitude and latitude by pyproj 3.7. */
const CORNERS: { m: [number, number]; deg: [number, number] }[] = [
  { m: [429264.313370022, 5150497.424942633], deg: [-93.92193038446514, 46.50433067448321] },
  { m: [429640.313370022, 5150497.424942633], deg: [-93.91703044640525, 46.50437006605273] },
  { m: [429264.313370022, 5150873.424942633], deg: [-93.92198758969701, 46.507714064418316] },
  { m: [429640.313370022, 5150873.424942633], deg: [-93.91708734770305, 46.507753460615575] },
];
const MIDDLE_M = [429452.313370022, 5150685.424942633] as const;
const EDGE_M = 400;

test("the place under the pointer and under the cursor is told in degrees and metres", async ({ page, service }) => {
  await service.storeMap("maps/minnesota.tif", "image/tiff");
  await page.goto(service.url);
  await expect(page.locator(".north-arrow")).toHaveAttribute("aria-label", "Grid north, 0.7° from true north");
  const told = page.locator(".map-coordinates");
  let box = (await paths(page).boundingBox())!;
  // By pyproj the middle is 93.919509 W, 46.506042 N; a pixel is half a metre. The page may still be growing.
  await expect(async () => {
    box = (await paths(page).boundingBox())!;
    await page.mouse.move(0, 0);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await expect(told).toHaveText(/46\.50604\d°.N, 93\.9195\d\d°.W/, { timeout: 2000 });
  }).toPass();
  await expect(told).toHaveText(/x 42945\d\.\d, y 515068\d\.\d.m/);
  await page.mouse.move(box.x + box.width / 2, box.y - 40);
  await expect(told).toHaveCount(0);
  await page.getByRole("application", { name: /Map/ }).focus();
  await page.keyboard.press("ArrowRight");
  await expect(told).toHaveText(/46\.50604\d°.N/);
  await expect(page.locator("p[role=status]")).toHaveText(/46\.50604\d°.N, 93\.919\d+°.W/);
});

test("a pointer that rests where a map appears is told its place, and another one when the view moves", async ({ page, service }) => {
  await service.storeMap("maps/minnesota.tif", "image/tiff");
  let come = () => {};
  const wanted = new Promise<void>((resolve) => (come = resolve));
  await page.route("**/v1/maps", async (route) => {
    await wanted;
    await route.continue();
  });
  await page.goto(service.url);
  const box = (await paths(page).boundingBox())!;
  await page.mouse.move(box.x + box.width / 4, box.y + box.height / 4);
  come();
  const told = page.locator(".map-coordinates");
  await expect(told).toHaveText(/x 429\d{3}\.\d, y 515\d{4}\.\d.m/);
  const before = (await told.textContent())!;
  await page.getByRole("button", { name: "Zoom in" }).focus();
  await page.keyboard.press("Enter");
  await expect(told).not.toHaveText(before);
  await expect(told).toHaveText(/x 429\d{3}\.\d, y 515\d{4}\.\d.m/);
});

test("start and goal are typed in metres, parts and degrees, and what is wrong is said at the field", async ({ page, service }) => {
  await service.storeMap("maps/minnesota.tif", "image/tiff");
  await page.goto(service.url);
  const [start, goal] = [page.getByLabel("Start at"), page.getByLabel("Goal at")];
  await start.fill("46.50433067N, 93.92193038W, 90");
  await start.press("Enter");
  await expect(start).toHaveValue(/^429264\.3\d*, 5150497\.4\d*, 90°$/);
  await goal.fill("46,505; 93");
  await goal.press("Enter");
  await expect(goal).toHaveAttribute("aria-invalid", "true");
  await expect(page.locator("#place-goal-about")).toHaveText(/off the map, which has x 429252\.3 to 429652\.3 m/);
  await goal.press("Escape");
  await expect(goal).toHaveAttribute("aria-invalid", "false");
  await goal.fill("46.506042, -93.919509");
  await goal.press("Enter");
  await expect(goal).toHaveValue(/^42945[12]\.\d+, 515068[45]\.\d+$/);
  await goal.fill("@0.5,0.25");
  await goal.press("Tab");
  await expect(goal).toHaveValue("429452.313, 5150585.425");
  await expect.poll(() => page.url()).toMatch(/start=429264\.3\d*,5150497\.4\d*,1\.5708&goal=429452\.313,5150585\.425/);
  await expect(page.getByRole("region", { name: "Paths compared" })).toBeVisible();
});

test("degrees on a map that does not say where it lies are refused at the field", async ({ page, service }) => {
  await service.storeMap("maps/yard.json", "application/json");
  await page.goto(service.url);
  await expect(page.locator(".north-arrow")).toHaveAttribute("aria-label", "North by the map's y axis");
  const start = page.getByLabel("Start at");
  await start.fill("46.5N, 93.9W");
  await start.press("Enter");
  await expect(page.locator("#place-start-about")).toHaveText(/does not say where on earth it lies/);
  await start.fill("4,5; 8");
  await start.press("Enter");
  await expect(start).toHaveValue("4.5, 8");
});

test("a map keeps the name of its file, and is read as the options say", async ({ page, service }) => {
  await page.goto(service.url);
  await page.getByText("Options", { exact: true }).click();
  await page.getByLabel("Elevation of unknown cells").fill("two");
  await expect(page.getByText("This is no number of metres.")).toBeVisible();
  await page.getByLabel("Elevation of unknown cells").fill("0");
  await page.locator(".first-map input[type=file]").setInputFiles(repositoryFile("maps/yard.json"));
  await expect(page.getByLabel("Map", { exact: true })).toContainText("yard.json");
  await expect(page.getByRole("list", { name: "Doubts about the map" })).toContainText(/No cell holds 0/);
  const listed = (await (await fetch(`${service.url}/v1/maps`)).json()) as { maps: { name: string }[] };
  expect(listed.maps.map(({ name }) => name)).toEqual(["yard.json"]);
});

test("an array is added once its cells have a size", async ({ page, service }) => {
  await page.goto(service.url);
  const choose = () => page.locator(".first-map input[type=file]").setInputFiles(repositoryFile("maps/hill.npy"));
  await choose();
  await expect(page.getByText("An array does not say how large its cells are.")).toBeVisible();
  await page.getByText("Options", { exact: true }).click();
  await page.getByLabel("Cell size of an array").fill("0,5");
  await choose();
  await expect(page.getByLabel("Map", { exact: true })).toContainText("hill.npy");
  const listed = (await (await fetch(`${service.url}/v1/maps`)).json()) as { maps: { id: string }[] };
  const map = (await (await fetch(`${service.url}/v1/maps/${listed.maps[0]?.id}`)).json()) as { cell_size_m: number };
  expect(map.cell_size_m).toBe(0.5);
  // Of other files the size is their own.
  await page.locator(".map-bar input[type=file]").setInputFiles(repositoryFile("maps/yard.json"));
  await expect(page.getByLabel("Map", { exact: true })).toContainText("yard.json");
});

test(
  "tiles lie where they belong to a pixel, and only their host is asked beside the service",
  PHONE_TOO,
  async ({ page, context }, info) => {
    const tiles = await serveTiles(CORNERS.map(({ deg }) => deg));
    const service = await Service.start("--tiles", tiles.url, "--tiles-attribution", "Dots of this test");
    try {
      await service.storeMap("maps/minnesota.tif", "image/tiff");
      const outside: string[] = [];
      const origin = new URL(tiles.url).origin;
      page.on("request", (request) => [service.url, origin].some((own) => request.url().startsWith(own)) || outside.push(request.url()));
      const complaints: string[] = [];
      page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
      await page.goto(service.url);
      const button = page.getByRole("button", { name: "Tiles" });
      await expect(button).toBeVisible();
      expect(tiles.asked, "nobody is asked before they are wanted").toEqual([]);
      await button.click();
      await expect(page.getByText("Dots of this test")).toBeVisible();
      // What lies over the corners of the map is not looked at.
      const show = (visibility: string) =>
        page.evaluate((visibility) => {
          const over = ".map-foot, .map-zoom, .map-hint, .north-arrow";
          for (const element of document.querySelectorAll<HTMLElement>(over)) element.style.visibility = visibility;
        }, visibility);
      await show("hidden");
      const canvas = page.locator(".map-tiles");
      // The page may not read pixels of others, but a picture of it shows them.
      const reader = await context.newPage();
      const dots = async () => {
        // The frame may still find its place while the bar above it fills.
        const box = (await canvas.boundingBox())!;
        const px_per_m = fittedWidth(box) / EDGE_M;
        const expected = CORNERS.map(({ m: [x_m, y_m] }) => ({
          x: box.width / 2 + (x_m - MIDDLE_M[0]) * px_per_m,
          y: box.height / 2 - (y_m - MIDDLE_M[1]) * px_per_m,
        }));
        const shot = (await page.screenshot({ scale: "css", clip: box })).toString("base64");
        return reader.evaluate(
          async ([data, near]) => {
            const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
            const sheet = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
            sheet.drawImage(image, 0, 0);
            const REACH = 14;
            return near.map(({ x, y }) => {
              let [weight, sumX, sumY] = [0, 0, 0];
              const [left, top] = [Math.round(x) - REACH, Math.round(y) - REACH];
              const { data: pixels } = sheet.getImageData(left, top, 2 * REACH, 2 * REACH);
              for (let i = 0; i < pixels.length; i += 4) {
                // How red it is beside the green ground.
                const red = Math.max(0, pixels[i]! - pixels[i + 1]!) / 255;
                weight += red;
                sumX += red * (left + ((i / 4) % (2 * REACH)) + 0.5);
                sumY += red * (top + Math.floor(i / 4 / (2 * REACH)) + 0.5);
              }
              return weight > 4 ? Math.hypot(sumX / weight - x, sumY / weight - y) : Infinity;
            });
          },
          [shot, expected] as const,
        );
      };
      await expect.poll(async () => Math.max(...(await dots()))).toBeLessThan(1);
      console.log(`    dots are off by ${(await dots()).map((off) => off.toFixed(2)).join(", ")} px`);
      await reader.close();
      await show("");
      await checkAccessible(page, "with tiles");
      await picture(page, `tiles-${info.project.name}`);
      expect(outside).toEqual([]);
      expect(complaints).toEqual([]);
    } finally {
      service.end();
      tiles.server.close();
    }
  },
);

test("without a place for tiles there is no choice of them, and the policy allows no other host", async ({ page, service }) => {
  const policy = (await fetch(service.url)).headers.get("content-security-policy");
  expect(policy).toContain("default-src 'self';");
  expect(policy).not.toContain("img-src");
  await service.storeMap("maps/minnesota.tif", "image/tiff");
  await page.goto(service.url);
  await expect(page.locator(".north-arrow")).toHaveAttribute("aria-label", /Grid north/);
  await expect(page.getByRole("button", { name: "Tiles" })).toHaveCount(0);
});
