import { answered, expect, test } from "./service";

test("start and goal can be set, and the start turned, by keys alone", async ({ page, service }) => {
  await service.storeMap("maps/yard.json", "application/json");
  await page.goto(service.url);
  const map = page.getByRole("application", { name: /Map/ });
  await map.focus();
  for (let i = 0; i < 3; i++) await page.keyboard.press("Shift+ArrowLeft");
  await page.keyboard.press("s");
  await expect(page.locator("p[role=status]")).toHaveText(/Start: .* east, .* north/);
  for (let i = 0; i < 7; i++) await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("Enter");
  await answered(page);
  await page.keyboard.press("[");
  await answered(page);
  await expect.poll(() => page.url()).toMatch(/start=[^,]*,[^,]*,0\.39/);
  await page.keyboard.press("+");
  await page.keyboard.press("0");
});

test("every tab is reached and left by keys, with a focus that is seen", async ({ page, service }) => {
  await page.goto(service.url);
  await page.keyboard.press("Tab");
  await expect(page.getByText("Skip to the content")).toBeFocused();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("heading", { name: "Robots" })).toBeVisible();
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement!).outlineStyle);
  expect(outline).toBe("solid");
});
