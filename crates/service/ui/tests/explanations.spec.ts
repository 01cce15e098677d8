/** The report of a diagnosis with a posterior, as a service would tell it. */
import type { Page } from "@playwright/test";
import { checkAccessible, expect, picture, test, type Service, PHONE_TOO } from "./service";

const JOB = "a".repeat(64);

const payload = {
  mechanism: "payload",
  statement: "payload of 25.3 kg, from about 400 s of drive tuesday on",
  equation: "m → m + m_p",
  parameters: [
    { name: "mass_kg", value: 25.3, unit: "kg", interval_95: [22.1, 28.4] },
    { name: "from_s", value: 400, unit: "s", interval_95: null },
  ],
  evidence: { p_value: 0.022, delta_bic: 20, held_out_gain: 0.8 },
  indistinguishable_from: ["towed_load"],
  fit: { held_out_rmse_before_w: 6, held_out_rmse_after_w: 2.1 },
  probability: 0.978,
  scope: { from_s: 400, until_s: null, run: "tuesday", region: null },
};

const seconds = Array.from({ length: 600 }, (_, i) => i + 0.5);
const recorded = seconds.map((t_s) => (t_s < 400 ? 100 : 130));

const report = {
  verdict: "explained",
  sentence: "The robot file predicts these drives 27.0 W too low on average (35.0 W RMSE; noise 1.9 W). Payload of 25.3 kg.",
  file: { rmse_w: 35, bias_w: 27, mean_power_w: 100 },
  probability: { nothing: 0.02, listed: 0.928, unlisted: 0.052 },
  explanations: [
    { mechanisms: ["payload"], probability: 0.9 },
    { mechanisms: ["payload", "unknown"], probability: 0.05 },
    { mechanisms: [], probability: 0.02 },
  ],
  baseline: { rmse_w: 18, bias_w: 13, held_out_rmse_w: 6, noise_floor_w: 1.9 },
  where: [],
  findings: [payload],
  corrected: { rmse_w: 2, held_out_rmse_w: 2.1 },
  next_drive: "drive a slope of 5° up and down",
  detectable: [{ mechanism: "wind", parameter: "east_mps", value: 2, unit: "m/s" }],
  not_judged: ["motor_heating"],
  notes: ["the model is taken to miss 0.3 % of power smoothly, by the healthy drives"],
  robot: { name: "husky-a200" },
  trace: {
    run: seconds.map(() => 0),
    t_s: seconds,
    recorded_w: recorded,
    filed_w: seconds.map(() => 100),
    corrected_w: recorded,
    runs: ["tuesday"],
    position_m: seconds.map((t_s) => [t_s, 40 * Math.sin(t_s / 50)]),
  },
};

async function open(page: Page, service: Service, result: object): Promise<void> {
  const done = { id: JOB, kind: "diagnose", state: "done", progress: { step: "done", fraction: 1 }, result };
  await page.route(`**/v1/jobs/${JOB}`, (route) => route.fulfill({ json: done }));
  await page.goto(`${service.url}/#diagnose?job=${JOB}`);
  await expect(page.locator(".verdict")).toBeVisible();
}

test("the file's error comes first, then the explanations, then the findings", PHONE_TOO, async ({ page, service }, info) => {
  await open(page, service, report);
  await expect(page.locator(".report h3")).toHaveText([
    "Error of the robot file",
    "Explanations",
    /^Payload/,
    "Errors before and after",
    "On the ground",
    "Next drive",
    "Notes",
  ]);
  const error = page.getByRole("region", { name: "Error of the robot file" });
  await expect(error).toContainText(/27\.0\sW too low on average, 27\.0\s% of the mean power of 100\sW \(35\.0\sW RMSE; noise 1\.9\sW\)/);
  await expect(page.getByRole("region", { name: "payload", exact: true })).toContainText("from 400 s of drive tuesday on");
  await page.screenshot({ path: info.outputPath("posterior-full.png"), fullPage: true });
  await picture(page, `posterior-${info.project.name}`);
});

test(
  "bars of explanations have names and values, in light and dark colours and on narrow screens",
  PHONE_TOO,
  async ({ page, service }) => {
    await open(page, service, report);
    const meter = (name: string) => page.getByRole("meter", { name, exact: true });
    await expect(meter("payload")).toHaveAttribute("aria-valuenow", "90");
    await expect(meter("payload")).toHaveAttribute("aria-valuetext", /^90\.0\s%, odds 45 : 1$/);
    await expect(meter("payload + something outside the list")).toHaveAttribute("aria-valuenow", "5");
    await expect(meter("nothing missing")).toHaveAttribute("aria-valuetext", /^2\.0\s%$/);
    await expect(meter("all others together")).toHaveAttribute("aria-valuenow", "3");
    await expect(page.getByText(/against the runner-up, .*: 18 : 1\./)).toBeVisible();
    await checkAccessible(page, "posterior");
    await page.getByRole("button", { name: "Switch to dark colours" }).click();
    await checkAccessible(page, "posterior in dark colours");
    await page.setViewportSize({ width: 320, height: 700 });
    await checkAccessible(page, "posterior on a narrow screen");
  },
);

test("a report without a posterior is shown without bars", async ({ page, service }) => {
  const { file: _file, probability: _probability, explanations: _explanations, ...without } = report;
  const { probability: _of, scope: _scope, ...finding } = payload;
  await open(page, service, { ...without, findings: [finding], verdict: "ambiguous" });
  await expect(page.getByRole("region", { name: "Error of the robot file" })).toContainText(/13\.0\sW too low/);
  await expect(page.getByRole("meter")).toHaveCount(0);
  await expect(page.getByText("Chance of as much by accident")).toBeVisible();
});
