import { answered, checkAccessible, expect, openSample, paths, picture, press, test, PHONE_TOO } from "./service";
import type { Page } from "@playwright/test";

const startOf = (page: Page) => /start=([^&]*)/.exec(page.url())?.[1];

test("changes are undone and done again, by keys, by buttons and by the browser", async ({ page, service }) => {
  await openSample(page, service);
  await expect.poll(() => startOf(page)).toBeTruthy();
  const first = startOf(page);
  await page.getByLabel("Start at").fill("@0.3,0.3");
  await page.getByLabel("Start at").press("Enter");
  await expect.poll(() => startOf(page)).not.toBe(first);
  const second = startOf(page);
  const ground = page.locator(".question select").nth(1);
  await ground.selectOption("sandy_loam");
  await expect.poll(() => page.url()).toContain("surface=sandy_loam");
  // The ground stays when the robot changes.
  await page.locator(".question select").first().selectOption("husky-a200-field");
  await expect.poll(() => page.url()).toContain("robot=husky-a200-field");
  await expect(ground).toHaveValue("sandy_loam");
  await page.getByRole("button", { name: "Step back" }).click();
  await expect.poll(() => page.url()).not.toContain("robot=husky-a200-field");
  await page.locator("h1").click();
  await page.keyboard.press("Control+z");
  await expect.poll(() => page.url()).not.toContain("surface=");
  await page.goBack();
  await expect.poll(() => startOf(page)).toBe(first);
  await page.getByRole("button", { name: "Step forward" }).click();
  await expect.poll(() => startOf(page)).toBe(second);
  await answered(page);
});

test(
  "distances are measured, the keys are told, and the sample is at hand beside another map",
  PHONE_TOO,
  async ({ page, service }, info) => {
    await service.storeMap("maps/yard.json", "application/json");
    await page.goto(service.url);
    await expect(page.locator(".legend")).toBeVisible();
    await page.getByRole("button", { name: "Measure" }).click();
    await paths(page).scrollIntoViewIfNeeded();
    await press(page, 0.4, 0.5);
    await press(page, 0.6, 0.5);
    await expect(page.locator(".map-hint")).toHaveText(/^\d+\.\d\sm, \d+\.\d\sm up, \d+\.\d\sm down$/);
    await picture(page, `measure-${info.project.name}`);
    await page.locator("h1").click();
    if (info.project.name === "desktop") await page.getByRole("button", { name: "Keys" }).click();
    else await page.keyboard.press("?");
    const sheet = page.getByRole("dialog", { name: "Keys" });
    await expect(sheet).toContainText("Undo the last change");
    await picture(page, `help-${info.project.name}`);
    await checkAccessible(page, "sheet of keys");
    await page.keyboard.press("Escape");
    await expect(sheet).toBeHidden();
    await page.locator(".map-choice select").selectOption("Sample map of Minnesota");
    await answered(page);
  },
);
