import { existsSync } from "node:fs";
import { defineConfig } from "@playwright/test";

/** The system's own browser: none is downloaded. */
const browsers = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executablePath = process.env.CHROMIUM ?? browsers.find((path) => existsSync(path)) ?? "/usr/bin/chromium";

/** A page that does not come from this machine's own service may not ask others on it, as the tiles of a test. */
const ofDist = process.env.DIST ? ["--disable-features=LocalNetworkAccessChecks"] : [];

export default defineConfig({
  testDir: "tests",
  workers: 1,
  // Drawing in software takes long where a machine has little to give; none of these bounds says how quick the page should be.
  timeout: 300_000,
  expect: { timeout: 60_000 },
  reporter: [["list"]],
  use: {
    // Containers have neither a graphics card nor user namespaces.
    launchOptions: { executablePath, args: ["--enable-unsafe-swiftshader", "--no-sandbox", ...ofDist] },
    reducedMotion: "reduce",
    actionTimeout: 60_000,
    navigationTimeout: 60_000,
    trace: "off",
  },
  projects: [
    { name: "desktop", use: { viewport: { width: 1440, height: 900 } } },
    // Tests that have nothing to do with the screen are not run twice.
    { name: "phone", grep: /@phone/, use: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 } },
  ],
});
