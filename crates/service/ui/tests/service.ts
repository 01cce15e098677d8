/** A service of its own for every test, with an empty store, and what tests ask of the page. */
import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { AxeBuilder } from "@axe-core/playwright";
import { test as base, expect, type Locator, type Page } from "@playwright/test";

const repository = resolve(import.meta.dirname, "../../../..");

/** The built program. */
export const program = process.env.JOULEPATH ?? join(repository, "target/ci/joulepath");
export const repositoryFile = (path: string) => join(repository, path);

export class Service {
  readonly folder = mkdtempSync(join(tmpdir(), "joulepath-page-"));
  private constructor(
    readonly url: string,
    private readonly child: ChildProcess,
  ) {}

  static async start(...more: string[]): Promise<Service> {
    const folder = mkdtempSync(join(tmpdir(), "joulepath-store-"));
    const child = spawn(program, ["serve", "--bind", "127.0.0.1:0", "--store", folder, ...more], { stdio: ["ignore", "pipe", "ignore"] });
    child.once("exit", () => rmSync(folder, { recursive: true, force: true }));
    for await (const line of createInterface({ input: child.stdout! })) {
      const url = /http:\/\/\S+/.exec(line)?.[0];
      if (url) return new Service(url, child);
    }
    throw new Error(`${program} does not start: build it, or name it by JOULEPATH`);
  }

  end(): void {
    this.child.kill("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true });
  }

  /** Stores a map of the repository. Returns its id. */
  async storeMap(path: string, type: string): Promise<string> {
    const { readFileSync } = await import("node:fs");
    const response = await fetch(`${this.url}/v1/maps`, {
      method: "POST",
      headers: { "content-type": type },
      body: readFileSync(repositoryFile(path)),
    });
    return ((await response.json()) as { id: string }).id;
  }

  /** A recording of a drive in a world, by the independent simulator. Returns its path. */
  simulate(name: string, world: object, drive: object): string {
    const path = (ending: string) => join(this.folder, `${name}${ending}`);
    const { writeFileSync } = process.getBuiltinModule("node:fs");
    writeFileSync(path("-world.json"), JSON.stringify(world));
    writeFileSync(path("-drive.json"), JSON.stringify(drive));
    const outcome = spawnSync(program, ["simulate", "--world", path("-world.json"), "--drive", path("-drive.json"), "--out", path(".csv")]);
    expect(outcome.status, String(outcome.stderr)).toBe(0);
    return path(".csv");
  }
}

/** With DIST the page comes from that folder instead of the program, which then need not be built for every change of it. */
const dist = process.env.DIST;

export const test = base.extend<{ service: Service }>({
  context: async ({ context }, use) => {
    if (dist) {
      await context.route(/:\d+\/(page\/[^?]*)?$/, (route) => {
        const path = new URL(route.request().url()).pathname;
        // The settings are the service's own.
        if (path === "/page/settings.json") return route.continue();
        return route.fulfill({ path: join(dist, path === "/" ? "index.html" : path) });
      });
    }
    await use(context);
  },
  service: async ({ browserName: _ }, use) => {
    const service = await Service.start();
    await use(service);
    service.end();
  },
});

/** Tests that run at the width of a phone too: of what is laid out, pressed or drawn otherwise there. All others run once. */
export const PHONE_TOO = { tag: "@phone" };

/** How many colours a canvas shows, over a grid of its pixels: a blank one has one. */
export function colors(canvas: Locator): Promise<number> {
  return canvas.evaluate((element: HTMLCanvasElement) => {
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [120, 120];
    const context = copy.getContext("2d")!;
    context.drawImage(element, 0, 0, 120, 120);
    const { data } = context.getImageData(0, 0, 120, 120);
    const seen = new Set<number>();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i]! << 24) | (data[i + 1]! << 16) | (data[i + 2]! << 8) | data[i + 3]!);
    return seen.size;
  });
}

/** The picture of the ground and that of the paths, read from the page. */
export const ground = (page: Page) => page.locator(".map-ground");
export const paths = (page: Page) => page.locator(".map-over");

/** Opens the page with the sample map and waits for the answer. Pictures of the guide show the robot of the field. */
export async function openSample(page: Page, service: Service, robot = "husky-a200"): Promise<void> {
  await page.goto(`${service.url}/#plan?robot=${robot}`);
  await page.getByRole("button", { name: "Open the sample map" }).click();
  await answered(page);
}

/** Waits until the paths that are asked for are there. */
export async function answered(page: Page): Promise<void> {
  await expect(page.getByRole("region", { name: "Paths compared" })).toHaveAttribute("aria-busy", "false");
}

/** The energy of a path in the table, in the unit of its heading. */
export async function energyOf(page: Page, path: string): Promise<number> {
  const row = page.getByRole("row", { name: new RegExp(`^${path}`) });
  return Number(await row.locator("td b").innerText());
}

/** Height that the rows above and below the map take on a phone [px]. */
const ROWS_PX = 120;

/** The width of a map that fills its frame [px], by the ratio of the map's width to its height. */
export function fittedWidth(frame: { width: number; height: number }, aspect = 1): number {
  const isPhone = frame.width < 620;
  const height = Math.min(0.96 * frame.height, frame.height - (isPhone ? Math.min(ROWS_PX, frame.height / 3) : 0));
  return Math.min(0.96 * frame.width, height * aspect);
}

/** The pixel of a place of the fitted map, by parts of its width and height from the south-west. */
export async function pixel(page: Page, [right, up]: [number, number], aspect = 1): Promise<[number, number]> {
  const box = (await paths(page).boundingBox())!;
  const width = fittedWidth(box, aspect);
  return [box.x + box.width / 2 + (right - 0.5) * width, box.y + box.height / 2 - ((up - 0.5) * width) / aspect];
}

/** Presses a place of the map's frame, by shares of its width and height from the lower left. */
export async function press(page: Page, right: number, up: number): Promise<void> {
  const box = (await paths(page).boundingBox())!;
  await page.mouse.click(box.x + right * box.width, box.y + (1 - up) * box.height);
}

/** Pictures that the README shows. */
const SHOWN = ["plan-desktop", "plan-phone", "relief-desktop", "diagnosis-desktop"];

/** A picture of what a test sees, for who looks into its results, or for the README where those are wanted. */
export async function picture(page: Page, name: string): Promise<void> {
  const folder = process.env.JOULEPATH_PICTURES;
  const isShown = folder !== undefined && SHOWN.includes(name);
  await page.screenshot({ path: isShown ? join(folder, `${name}.png`) : test.info().outputPath(`${name}.png`), scale: "css" });
}

/** Fails when axe finds what is serious or worse, or when the page is wider than its window. */
export async function checkAccessible(page: Page, where: string): Promise<void> {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const grave = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  const said = grave.flatMap(({ id, nodes }) =>
    nodes.map(({ target, failureSummary }) => `${where}: ${id} at ${target.join(" ")}: ${failureSummary}`),
  );
  expect(said).toEqual([]);
  const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  expect(over, `${where}: pixels beyond the window`).toBeLessThanOrEqual(0);
}

export { expect };
