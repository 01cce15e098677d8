import { checkAccessible, expect, picture, test, PHONE_TOO } from "./service";

test("a parameter is changed, saved as a new robot, and planned with", PHONE_TOO, async ({ page, service }, info) => {
  await page.goto(`${service.url}/#robots`);
  await expect(page.getByLabel("Mass", { exact: true }).first()).toHaveValue("90");
  await picture(page, `robots-${info.project.name}`);
  await expect(page.getByText("With everything on board; 0.1 to 20000 kg")).toBeVisible();
  await page.getByLabel("Mass", { exact: true }).first().fill("112,5");
  await page.getByLabel("Name").fill("heavy");
  await page.getByRole("button", { name: "Save as new" }).click();
  await expect(page.getByRole("button", { name: /heavy.*stored/ })).toBeVisible();
  const { stored } = (await (await page.request.get(`${service.url}/v1/robots`)).json()) as { stored: { robot: { mass_kg: number } }[] };
  expect(stored[0]!.robot.mass_kg).toBe(112.5);
  const comparison = page.getByRole("region", { name: "Compare robots" });
  await comparison.getByLabel("Compare with").selectOption("husky-a200-field");
  await expect(comparison.getByRole("row", { name: /Body: Mass/ })).toHaveText(/kg\s*112\.5\s*90$/);
  await expect(comparison.getByRole("row")).toHaveCount(2);
  await picture(page, `robots-compared-${info.project.name}`);
  await checkAccessible(page, "robots compared");
  await page.getByRole("button", { name: "Plan with it" }).click();
  await expect.poll(() => page.url()).toContain("robot=");
  await page.getByRole("button", { name: "Robots" }).click();
  await page.getByRole("button", { name: "Delete" }).click();
  await page.getByRole("button", { name: "Delete for good" }).click();
  await expect(page.getByRole("button", { name: /heavy.*stored/ })).toHaveCount(0);
  const left = (await (await page.request.get(`${service.url}/v1/robots`)).json()) as { stored?: unknown[] };
  expect(left.stored ?? []).toEqual([]);
});

test("a value outside its range is said at its field, before and by the service", async ({ page, service }) => {
  await page.goto(`${service.url}/#robots`);
  const mass = page.getByLabel("Mass", { exact: true }).first();
  await mass.fill("95;5");
  await mass.blur();
  await expect(mass, "what was typed stays").toHaveValue("95;5");
  await expect(page.getByText("Give a number, as 95.5 or 95,5")).toBeVisible();
  await mass.fill("900000");
  await expect(mass).toHaveAttribute("aria-invalid", "true");
  await expect(page.getByText("Must lie between 0.1 and 20000 kg")).toBeVisible();
  await expect(page.getByRole("button", { name: "Save as new" })).toBeDisabled();
  await mass.fill("90");
  // Within the page's range, but outside the wheels: only the service knows.
  const forward = page.getByLabel("Forward");
  await forward.fill("2");
  await page.getByRole("button", { name: "Save as new" }).click();
  await expect(forward).toHaveAttribute("aria-invalid", "true");
  await expect(page.getByText(/inside the wheels/).first()).toBeVisible();
});

test("a mechanism's numbers have the units and ranges that the service states for this robot", PHONE_TOO, async ({ page, service }) => {
  const husky = (await (await page.request.get(`${service.url}/v1/robots/husky-a200`)).json()) as object;
  const drag = { mechanism: "drivetrain_drag", parameters: { left_n: 21, right_n: 0 } };
  const posted = await page.request.post(`${service.url}/v1/robots`, { data: { ...husky, name: "dragging", mechanisms: [drag] } });
  expect(posted.status()).toBe(201);
  await page.goto(`${service.url}/#robots`);
  await page.getByRole("button", { name: /dragging.*stored/ }).click();
  const group = page.getByRole("group", { name: "drivetrain drag" });
  await expect(group.getByText("\u221210 to 300 N")).toHaveCount(2);
  const left = group.getByLabel("left");
  await left.fill("301");
  await expect(group.getByText("Must lie between \u221210 and 300 N")).toBeVisible();
  await expect(page.getByRole("button", { name: "Save as new" })).toBeDisabled();
  await left.fill("250");
  await expect(left).toHaveAttribute("aria-invalid", "false");
  // Ten times the mass may drag ten times as much, which the service knows and the page does not say.
  await page.getByLabel("Mass", { exact: true }).first().fill("900");
  await left.fill("2500");
  await checkAccessible(page, "a robot with a mechanism");
  await page.getByRole("button", { name: "Save as new" }).click();
  await expect(group.getByText("\u2212100 to 3000 N")).toHaveCount(2);
});

test("a robot's file is taken up, and a wrong one refused", async ({ page, service }) => {
  await page.goto(`${service.url}/#robots`);
  const robot = (await (await page.request.get(`${service.url}/v1/robots/husky-a200`)).json()) as object;
  const input = page.locator(".robot-list input[type=file]");
  await input.setInputFiles({
    name: "mine.json",
    mimeType: "application/json",
    buffer: Buffer.from(JSON.stringify({ ...robot, name: "mine" })),
  });
  await expect(page.getByRole("button", { name: /mine.*stored/ })).toBeVisible();
  await input.setInputFiles({ name: "text.json", mimeType: "application/json", buffer: Buffer.from("not json") });
  await expect(page.getByRole("alert")).toContainText("is not JSON");
});
