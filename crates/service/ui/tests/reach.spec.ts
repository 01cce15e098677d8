import { colors, expect, openSample, paths, picture, test } from "./service";

test("contours of energy are drawn about the start", async ({ page, service }, info) => {
  const { paths: known } = (await (await page.request.get(`${service.url}/openapi.json`)).json()) as { paths: object };
  test.skip(!("/v1/reachable" in known), "this service has no contours, and the page does not offer them");
  await openSample(page, service);
  const before = await paths(page).screenshot();
  const drawn = page.waitForResponse((response) => response.url().endsWith("/v1/reachable"));
  await page.getByLabel("Contours of energy").selectOption("Reach from start");
  expect((await drawn).status()).toBe(200);
  await expect.poll(async () => (await paths(page).screenshot()).equals(before)).toBe(false);
  expect(await colors(paths(page))).toBeGreaterThan(20);
  await picture(page, `reach-${info.project.name}`);
});

test("a service without contours is not asked for them", async ({ page, service }) => {
  await page.route("**/openapi.json", (route) => route.fulfill({ json: { paths: {} } }));
  await openSample(page, service);
  await expect(page.getByLabel("Contours of energy")).toHaveCount(0);
});
