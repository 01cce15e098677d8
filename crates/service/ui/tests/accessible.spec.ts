import { checkAccessible, expect, openSample, test, PHONE_TOO } from "./service";

for (const scheme of ["light", "dark"] as const) {
  test(`axe finds nothing serious in ${scheme} colours`, scheme === "dark" ? PHONE_TOO : {}, async ({ page, service }) => {
    await page.emulateMedia({ colorScheme: scheme });
    const check = (where: string) => checkAccessible(page, where);
    await page.goto(service.url);
    await expect(page.getByRole("button", { name: "Open the sample map" })).toBeVisible();
    await check("without a map");
    await openSample(page, service);
    await check("plan");
    await page.getByRole("slider", { name: "Charge" }).press("Home");
    await check("plan without charge");
    await page.getByRole("button", { name: "3-D" }).click();
    await expect(page.locator(".relief-3d canvas")).toBeVisible();
    await check("three dimensions");
    await page.getByRole("button", { name: "Robots" }).click();
    await page.getByLabel("Mass", { exact: true }).first().fill("-1");
    await check("robots");
    await page.getByRole("button", { name: "Diagnose" }).click();
    const buffer = Buffer.from("no,recording\n1,2\n");
    await page.locator(".recordings input[type=file]").nth(0).setInputFiles({ name: "wrong.csv", mimeType: "text/csv", buffer });
    await expect(page.getByRole("alert")).toBeVisible();
    await check("diagnose");
  });
}
