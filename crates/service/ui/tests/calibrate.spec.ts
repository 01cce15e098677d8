import { answered, checkAccessible, expect, openSample, picture, test, PHONE_TOO } from "./service";

const { readFileSync } = process.getBuiltinModule("node:fs");

/** Names that no map of the program has, units beside them, dates, decimal commas and another order. */
const HEADER = [
  "Uhrzeit / time",
  "Rad rechts right wheel [rad/s]",
  "Rad links left wheel [rad/s]",
  "Akku P battery [kW]",
  "Neigung pitch (deg)",
  "Notiz",
];
const WHEEL_RADIUS_M = 0.165;

/** A recording of the simulator, written as somebody's own logger would. */
function oddly(path: string): string {
  const [header = "", ...rows] = readFileSync(path, "utf8").trim().split("\n");
  const names = header.split(",");
  const at = (name: string) => names.indexOf(name);
  const comma = (value: number, places: number) => (Number.isFinite(value) ? value.toFixed(places).replace(".", ",") : "");
  const lines = rows.map((row) => {
    const cells = row.split(",");
    const value = (name: string) => (cells[at(name)] === "" ? NaN : Number(cells[at(name)]));
    const power_w = at("power_w") >= 0 ? value("power_w") : value("power_left_w") + value("power_right_w");
    return [
      new Date(Date.UTC(2026, 10, 28, 9) + 1000 * value("t_s")).toISOString(),
      comma(value("v_right_mps") / WHEEL_RADIUS_M, 4),
      comma(value("v_left_mps") / WHEEL_RADIUS_M, 4),
      comma(power_w / 1000, 5),
      comma((value("pitch_rad") * 180) / Math.PI, 3),
      "",
    ].join(";");
  });
  return [HEADER.join(";"), ...lines].join("\n");
}

/** An MCAP file of one topic of a team's own: schema, channel and messages of three doubles, by the format's specification. */
function bagOf(rows: { t_s: number; values: number[] }[]): Buffer {
  const u16 = (value: number) => Buffer.from(Uint16Array.of(value).buffer);
  const u32 = (value: number) => Buffer.from(Uint32Array.of(value).buffer);
  const u64 = (value: bigint) => Buffer.from(BigUint64Array.of(value).buffer);
  const text = (words: string) => Buffer.concat([u32(words.length), Buffer.from(words)]);
  const record = (opcode: number, ...parts: Buffer[]) => {
    const body = Buffer.concat(parts);
    return Buffer.concat([Buffer.of(opcode), u64(BigInt(body.length)), body]);
  };
  const definition = "float64 links\nfloat64 rechts\nfloat64 leistung\n";
  const messages = rows.map(({ t_s, values }, i) => {
    const t_ns = u64(BigInt(Math.round(1e6 * (1.76e9 + t_s))) * 1000n);
    return record(5, u16(1), u32(i), t_ns, t_ns, Buffer.of(0, 1, 0, 0), Buffer.from(Float64Array.from(values).buffer));
  });
  return Buffer.concat([
    Buffer.from("\x89MCAP0\r\n", "latin1"),
    record(3, u16(1), text("team_msgs/msg/Fahrt"), text("ros2msg"), text(definition)),
    record(4, u16(1), u16(1), text("/fahrt"), text("cdr"), u32(0)),
    ...messages,
    record(15, Buffer.alloc(4)),
    record(2, Buffer.alloc(20)),
    Buffer.from("\x89MCAP0\r\n", "latin1"),
  ]);
}

test("topics that no map knows are picked field by field, with a plot, and read", PHONE_TOO, async ({ page, service }, info) => {
  const rows = Array.from({ length: 1500 }, (_, i) => ({
    t_s: i / 10,
    values: [0.5 + 0.1 * Math.sin(i / 40), 0.5, 60 + 5 * Math.sin(i / 30)],
  }));
  await page.goto(`${service.url}/#calibrate`);
  await page
    .locator(".recordings input[type=file]")
    .setInputFiles({ name: "fahrt.mcap", mimeType: "application/octet-stream", buffer: bagOf(rows) });
  const picker = page.getByRole("region", { name: "Columns of the log" });
  // On a phone rows are cards, without a header.
  if (info.project.name === "desktop") await expect(picker.getByRole("columnheader", { name: "Topic and field" })).toBeVisible();
  await expect(picker.getByRole("rowheader")).toHaveText(["/fahrt links", "/fahrt rechts", "/fahrt leistung"]);
  await expect(picker.getByRole("status")).toContainText("Say which column is the left wheel speed");
  await expect(picker.getByLabel("/fahrt links is").getByRole("option", { name: "Time" }), "messages have their own").toHaveCount(0);
  await picker.getByLabel("/fahrt links is").selectOption("Left wheel speed");
  await picker.getByLabel("/fahrt rechts is").selectOption("Right wheel speed");
  await picker.getByLabel("/fahrt leistung is").selectOption("Battery power");
  await expect(picker.getByText(/^\/fahrt leistung, as it stands in the file, over the first 600 rows$/)).toBeVisible();
  await picture(page, `topics-${info.project.name}`);
  await checkAccessible(page, "topics");
  await picker.getByRole("button", { name: "Read with these columns" }).click();
  await expect(page.getByText("1,500")).toBeVisible();
  await expect(page.getByRole("cell", { name: "/fahrt leistung [W]", includeHidden: true })).toHaveCount(1);
});

test(
  "from odd CSV files to a corrected plan: columns are picked once, the robot is fitted, and plans stand side by side",
  PHONE_TOO,
  async ({ page, service }, info) => {
    const world = { terrain: { rolling: { grade: 0.04 } }, robot_seed: 11 };
    const files = [1, 2].map((seed) => ({
      name: `tag-${seed}.csv`,
      mimeType: "text/csv",
      buffer: Buffer.from(oddly(service.simulate(`drive-${seed}`, { ...world, seed }, { kind: "rich", duration_s: 300, seed: 6 + seed }))),
    }));
    await openSample(page, service);
    await page.getByRole("button", { name: "Calibrate" }).click();
    await page.locator(".recordings input[type=file]").setInputFiles(files);
    const picker = page.getByRole("region", { name: "Columns of the log" }).first();
    await expect(picker.getByLabel(`${HEADER[2]} is`)).toHaveValue("v_left_mps");
    await expect(picker.getByLabel(`Unit of ${HEADER[2]}`)).toHaveValue("rad/s");
    await expect(picker.getByLabel(`${HEADER[3]} is`)).toHaveValue("power_w");
    await expect(picker.getByLabel("Wheel radius")).toHaveValue(String(WHEEL_RADIUS_M));
    await picker.getByLabel(`${HEADER[3]} is`).selectOption("");
    await expect(picker.getByRole("status")).toContainText("Say which column is the power");
    await expect(picker.getByRole("button", { name: "Read with these columns" })).toBeDisabled();
    await picker.getByLabel(`${HEADER[3]} is`).selectOption("Battery power");
    await expect(picker.getByLabel(`Unit of ${HEADER[3]}`), "its name says it").toHaveValue("kW");
    await picker.getByLabel(`Unit of ${HEADER[3]}`).selectOption("W");
    await expect(picker).toContainText("The other recording with these columns is read alike.");
    await picture(page, `columns-${info.project.name}`);
    await checkAccessible(page, "columns");
    await picker.getByRole("button", { name: "Read with these columns" }).click();
    // The other file has the same columns, and is read with them too; so it is when one of them was wrong.
    await expect(page.getByText("3,000")).toHaveCount(2);
    await page.getByRole("button", { name: "Say what its columns are…" }).last().click();
    await expect(picker.getByLabel(`${HEADER[2]} is`)).toHaveValue("v_left_mps");
    await expect(picker.getByLabel(`Unit of ${HEADER[3]}`), "what was said stays").toHaveValue("W");
    await picker.getByLabel(`Unit of ${HEADER[3]}`).selectOption("kW");
    await picker.getByRole("button", { name: "Read with these columns" }).click();
    await expect(page.getByText("3,000")).toHaveCount(2);
    await expect(page.getByRole("cell", { name: `${HEADER[3]} [kW]`, includeHidden: true })).toHaveCount(2);
    await expect(page.getByLabel("Ground that was driven")).toHaveValue("marble");
    await page.locator(".diagnose-start").getByRole("button", { name: "Calibrate" }).click();
    await expect(page.locator(".calibration .verdict")).toBeVisible({ timeout: 120_000 });
    await expect(page.getByRole("region", { name: "Skill" })).toContainText("R², one-second averages");
    await expect(page.getByRole("region", { name: "Parameters", exact: true })).toContainText("mu skid");
    await picture(page, `calibrated-${info.project.name}`);
    await checkAccessible(page, "calibration");
    await expect.poll(() => page.url()).toContain("calibration=");
    await page.getByRole("button", { name: "Save the fitted robot and plan with it" }).click();
    await answered(page);
    await expect(page.getByRole("row", { name: /^Before correction/ })).toBeVisible();
  },
);

test("a refusal for doubtful recordings names the doubts, and they may be overruled", async ({ page, service }) => {
  const id = "b".repeat(32);
  const detail =
    "no robot was written, because the recording is doubtful: power is negative; if it is right, calibrate `--despite power_sign`";
  const problem = { type: "invalid-recording", title: "The recording cannot be used", status: 400, detail };
  const failed = { id, kind: "calibrate", state: "failed", progress: { step: "fitting", fraction: null }, problem };
  await page.route(`**/v1/jobs/${id}`, (route) => route.fulfill({ json: failed }));
  await page.route("**/v1/calibrate", (route) => route.fulfill({ status: 202, json: failed }));
  await page.goto(`${service.url}/#calibrate?calibration=${id}`);
  await expect(page.getByRole("alert")).toContainText("power is negative");
  await expect(page.getByText("overrule the doubts: power_sign")).toBeVisible();
  await expect(page.getByRole("button", { name: "Back to the recordings" })).toBeVisible();
  const asked = page.waitForRequest("**/v1/calibrate");
  await page.getByRole("button", { name: "Calibrate despite them" }).click();
  expect((await asked).postDataJSON()).toMatchObject({ despite: ["power_sign"] });
});

test("drives that do not name their ground are fitted on the one that is chosen, and plans are over it", async ({ page, service }) => {
  const path = service.simulate("drive", { terrain: "level", robot_seed: 11, seed: 1 }, { kind: "rich", duration_s: 60, seed: 7 });
  await openSample(page, service);
  await page.getByRole("button", { name: "Calibrate" }).click();
  await page.locator(".recordings input[type=file]").setInputFiles(path);
  await expect(page.getByLabel("Use drive.csv")).toBeVisible();
  await page.getByLabel("Ground that was driven").selectOption("sandy loam");
  const robot = (await (await page.request.get(`${service.url}/v1/robots/husky-a200`)).json()) as object;
  const result = { parameters: [], held_out: null, notes: [], robot: { ...robot, default_surface: "sandy_loam" } };
  const done = { id: "c".repeat(32), kind: "calibrate", state: "done", progress: { step: "done", fraction: 1 }, result };
  await page.route(`**/v1/jobs/${done.id}`, (route) => route.fulfill({ json: done }));
  await page.route("**/v1/calibrate", (route) => route.fulfill({ status: 202, json: done }));
  const asked = page.waitForRequest("**/v1/calibrate");
  await page.locator(".diagnose-start").getByRole("button", { name: "Calibrate" }).click();
  expect((await asked).postDataJSON()).toMatchObject({ robot: { name: "husky-a200", default_surface: "sandy_loam" } });
  await page.getByRole("button", { name: "Save the fitted robot and plan with it" }).click();
  await answered(page);
  await expect(page.getByRole("region", { name: "Question", exact: true }).getByRole("combobox", { name: /^Ground/ })).toHaveValue(
    "sandy_loam",
  );
});
