import { answered, expect, openSample, press, test } from "./service";

test("a file that is no map is refused by name of what is wrong with it", async ({ page, service }) => {
  await page.goto(service.url);
  await page
    .locator(".first-map input[type=file]")
    .setInputFiles({ name: "wrong.json", mimeType: "application/json", buffer: Buffer.from('{"rows": 2}') });
  await expect(page.getByRole("alert")).toContainText("The request cannot be read");
  await expect(page.getByRole("alert")).toContainText("Missing field");
});

test("a start where the robot cannot stand is said with what to do", async ({ page, service }) => {
  const id = await service.storeMap("maps/yard.json", "application/json");
  await page.goto(`${service.url}/#plan?map=${id}&start=-5,3&goal=20,12`);
  await expect(page.getByRole("alert")).toContainText("The start lies outside the map");
});

test("a service that went away is said, and asked again on demand", async ({ page, service }) => {
  await page.route("**/v1/maps", (route) => route.abort());
  await page.goto(service.url);
  await expect(page.getByRole("alert")).toContainText("joulepath serve");
  await page.unroute("**/v1/maps");
  await page.getByRole("button", { name: "Try again" }).click();
  await expect(page.getByRole("button", { name: "Open the sample map" })).toBeVisible();
});

test("a goal moved to where no path leads leaves the map usable", async ({ page, service }, info) => {
  await openSample(page, service);
  await page.route("**/v1/compare", (route) =>
    route.fulfill({
      status: 422,
      contentType: "application/problem+json",
      body: JSON.stringify({ type: "no-path", title: "There is no path", status: 422, detail: "no way leads from the start to the goal" }),
    }),
  );
  await page.getByRole("button", { name: "Goal", exact: true }).click();
  await press(page, 0.5, 0.5);
  await expect(page.getByRole("alert")).toContainText("There is no path");
  await page.unroute("**/v1/compare");
  await page.getByRole("button", { name: "Goal", exact: true }).click();
  await press(page, info.project.name === "phone" ? 0.5 : 0.55, 0.55);
  await answered(page);
});

test("a guarded service is asked again with the token that it wants", async ({ page, service }) => {
  await page.route("**/v1/**", (route) =>
    route.request().headers().authorization === "Bearer secret"
      ? route.continue()
      : route.fulfill({
          status: 401,
          contentType: "application/problem+json",
          body: JSON.stringify({ type: "unauthorized", title: "A token is needed", status: 401, detail: "this service wants a token" }),
        }),
  );
  await page.goto(service.url);
  const field = page.getByLabel("This service wants a token:");
  await expect(field).toHaveAccessibleDescription(/^Of a line NAME:TOKEN it is what stands behind the colon/);
  await expect(page.getByRole("alert"), "the form says what is wanted").toHaveCount(0);
  await field.fill("alice:secret");
  await page.getByRole("button", { name: "Go on" }).click();
  await expect(page.getByRole("alert")).toContainText("This is none of the service's tokens.");
  await field.fill("secret");
  await page.getByRole("button", { name: "Go on" }).click();
  await expect(page.getByRole("button", { name: "Open the sample map" })).toBeVisible();
  await page.getByRole("button", { name: "Open the sample map" }).click();
  await answered(page);
  expect(page.url()).not.toContain("secret");
});
