import { answered, checkAccessible, colors, expect, openSample, picture, test } from "./service";

const ground = { rolling: { grade: 0.04 } };

test("a drive is diagnosed, the corrected robot accepted, and old and new paths stand side by side", async ({ page, service }, info) => {
  const healthy = service.simulate("monday", { terrain: ground, seed: 1, robot_seed: 5 }, { kind: "rich", duration_s: 900, seed: 7 });
  const effects = [{ effect: "payload", strength: 25, onset_s: 400 }];
  const suspect = service.simulate(
    "tuesday",
    { terrain: ground, seed: 2, robot_seed: 5, effects },
    { kind: "rich", duration_s: 900, seed: 8 },
  );
  await openSample(page, service);
  await page.getByRole("button", { name: "Diagnose" }).click();

  await page.locator(".recordings input[type=file]").nth(0).setInputFiles(suspect);
  await page.locator(".recordings input[type=file]").nth(1).setInputFiles(healthy);
  await expect(page.getByText("9,000")).toHaveCount(2);
  await expect(page.getByText("Nothing suspicious.")).toHaveCount(2);
  await page.locator(".diagnose-start").getByRole("button", { name: "Diagnose" }).click();
  await expect(page.getByRole("progressbar")).toBeVisible();

  await expect(page.locator(".verdict")).toBeVisible({ timeout: 120_000 });
  await expect(page.locator(".verdict-name")).toHaveText(/Explained|Ambiguous/);
  await expect(page.getByRole("region", { name: "payload" })).toContainText("95 %");
  await expect(page.locator(".bars").last()).toContainText("noise floor");
  expect(await colors(page.locator(".time-axis canvas").last())).toBeGreaterThan(10);
  expect(await colors(page.locator(".drive-map canvas"))).toBeGreaterThan(10);
  const usual = page.viewportSize()!;
  await page.setViewportSize({ width: Math.min(usual.width, 1080), height: 1130 });
  await picture(page, `diagnosis-${info.project.name}`);
  await page.setViewportSize(usual);
  await checkAccessible(page, "report");
  await page.getByRole("button", { name: "Switch to dark colours" }).click();
  await checkAccessible(page, "report in dark colours");
  await page.getByRole("button", { name: "Switch to light colours" }).click();

  const link = page.url();
  expect(link).toContain("job=");
  await page.getByRole("button", { name: "Accept the corrected robot and plan with it" }).click();
  await answered(page);
  await expect(page.getByRole("row", { name: /^Before correction/ })).toBeVisible();
  await expect(page.getByText(/With the corrected robot/)).toBeVisible();
  await picture(page, `corrected-${info.project.name}`);

  await page.goto(link);
  await page.reload();
  await expect(page.locator(".verdict")).toBeVisible();
});

test("a diagnosis is called off", async ({ page, service }) => {
  const suspect = service.simulate("drive", { terrain: ground, seed: 3 }, { kind: "rich", duration_s: 1200, seed: 9 });
  await page.goto(`${service.url}/#diagnose`);
  await page.locator(".recordings input[type=file]").nth(0).setInputFiles(suspect);
  await page.locator(".diagnose-start").getByRole("button", { name: "Diagnose" }).click();
  await page.getByRole("button", { name: "Call it off" }).click();
  await expect(page.getByText("The diagnosis was called off.")).toBeVisible();
  await page.getByRole("button", { name: "Back to the recordings" }).click();
  await expect(page.getByRole("heading", { name: /When a drive took more/ })).toBeVisible();
});

test("a file that is no recording is refused with its line", async ({ page, service }) => {
  await page.goto(`${service.url}/#diagnose`);
  const buffer = Buffer.from("t_s,v_left_mps,v_right_mps,power_w\n1,0,0,5\n0.5,0,0,5\n");
  await page.locator(".recordings input[type=file]").nth(0).setInputFiles({ name: "wrong.csv", mimeType: "text/csv", buffer });
  await expect(page.getByRole("alert")).toContainText("Line 3");
  await expect(page.locator(".diagnose-start").getByRole("button", { name: "Diagnose" })).toBeDisabled();
});
