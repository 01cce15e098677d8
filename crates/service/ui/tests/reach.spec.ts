import type { Page } from "@playwright/test";
import { expect, openSample, paths, picture, test } from "./service";

/** The share of the map that something lies over. */
const painted = (page: Page) =>
  paths(page).evaluate((canvas: HTMLCanvasElement) => {
    const { data } = canvas.getContext("2d")!.getImageData(0, 0, canvas.width, canvas.height);
    let pixels = 0;
    for (let i = 3; i < data.length; i += 4) if (data[i]! > 0) pixels++;
    return (4 * pixels) / data.length;
  });

test("contours of energy are drawn about the start", async ({ page, service }, info) => {
  await openSample(page, service);
  const before = await painted(page);
  const drawn = page.waitForResponse((response) => response.url().endsWith("/v1/reachable"));
  await page.getByLabel("Contours of energy").selectOption("Reach from start");
  expect((await drawn).status()).toBe(200);
  // Contours of up to more than the path takes cover much of the map, about the start.
  await expect.poll(() => painted(page)).toBeGreaterThan(before + 0.2);
  await picture(page, `reach-${info.project.name}`);
});

test("a service without contours is not asked for them", async ({ page, service }) => {
  await page.route("**/openapi.json", (route) => route.fulfill({ json: { paths: {} } }));
  await service.storeMap("maps/yard.json", "application/json");
  await page.goto(service.url);
  await expect(page.getByRole("button", { name: "Slope" })).toBeVisible();
  await expect(page.getByLabel("Contours of energy")).toHaveCount(0);
});
