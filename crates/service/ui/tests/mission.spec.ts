import { answered, checkAccessible, expect, openSample, paths, picture, press, test, PHONE_TOO } from "./service";

const { readFileSync } = process.getBuiltinModule("node:fs");

interface MissionQuestion {
  waypoints: { x_m: number; y_m: number }[];
  return: boolean;
}

test("several stops are visited in the order of least energy, and one is removed again", PHONE_TOO, async ({ page, service }, info) => {
  await openSample(page, service);
  await page.getByRole("button", { name: "Several stops" }).click();
  const mission = page.getByRole("region", { name: "Mission" });
  // The goal is the first stop.
  await expect(page.getByRole("list", { name: "Stops" }).getByRole("listitem")).toHaveCount(1);
  await paths(page).scrollIntoViewIfNeeded();
  await press(page, 0.3, 0.7);
  await press(page, 0.6, 0.25);
  await expect(mission.getByRole("row")).toHaveCount(5);
  const asked = page.waitForRequest((request) => request.url().endsWith("/v1/mission") && request.postDataJSON().return === true);
  await page.getByLabel("Return to the start").check();
  const { waypoints } = (await asked).postDataJSON() as MissionQuestion;
  expect(waypoints).toHaveLength(3);
  await expect(mission.getByRole("row")).toHaveCount(6);
  // The goal that came first lies farthest away: the others are visited on the way there or back.
  await expect(mission.getByRole("row").nth(2)).toContainText(/given as [23]/);
  await expect(mission.getByRole("row").last()).toContainText("Back at the start");
  await expect(mission.locator(".charge")).toHaveAttribute("data-fine", "true");
  await expect(mission).toContainText(/keeps the reserve of 20\s% with a probability of 100\.0\s%/);
  await expect(page.locator(".chart")).toHaveCount(4);
  await picture(page, `mission-${info.project.name}`);
  await checkAccessible(page, "mission");
  await expect.poll(() => page.url()).toMatch(/visit=[\d.]+,[\d.]+;[\d.]+,[\d.]+;[\d.]+,[\d.]+&return/);
  await page.getByRole("button", { name: "Remove stop 3" }).click();
  await expect(mission.getByRole("row")).toHaveCount(5);
  await page.reload();
  await expect(mission.getByRole("row")).toHaveCount(5);
  const files = page.getByRole("group", { name: "Download the mission" });
  // Other forms than these two go the way of the second.
  for (const [form, name, holds] of [
    ["JSON", "mission.json", '"feasible"'],
    ["GPX", "mission.gpx", "<name>to waypoint"],
  ] as const) {
    const saving = page.waitForEvent("download");
    await files.getByRole("button", { name: form, exact: true }).click();
    const saved = await saving;
    expect(saved.suggestedFilename()).toBe(name);
    expect(readFileSync(await saved.path(), "utf8"), name).toContain(holds);
  }
  await page.getByRole("button", { name: "One goal" }).click();
  await answered(page);
});

test(
  "whether the battery lasts there and back is told with its uncertainty, and the way back is drawn",
  PHONE_TOO,
  async ({ page, service }, info) => {
    await openSample(page, service);
    const asked = page.waitForRequest((request) => request.url().endsWith("/v1/range"));
    await page.getByRole("button", { name: "There and back" }).click();
    expect((await asked).postDataJSON()).toMatchObject({ return: true, charge: 1 });
    const range = page.getByRole("region", { name: "Does the battery last?" });
    await expect(range).toContainText(/The robot may turn back as late as at the goal, and is home with [89]\d\.\d\s%/);
    await expect(range.locator(".charge")).toHaveAttribute("data-fine", "true");
    await page.getByLabel("Contours of energy").selectOption("Reach and back");
    await expect(page.locator(".reach-legend")).toContainText("There and back with");
    await expect(page.locator(".reach-steps i")).not.toHaveCount(1);
    await picture(page, `range-${info.project.name}`);
    await checkAccessible(page, "range");
    await page.getByRole("slider", { name: "Charge" }).press("Home");
    await expect(range).toContainText(/The charge of 5\s% is not above the reserve of 20\s%/);
    await expect(range.locator(".charge")).toHaveCount(0);
    await expect.poll(() => page.url()).toContain("range=return");
  },
);
