import { existsSync } from "node:fs";
import { defineConfig } from "@playwright/test";

/** The system's own browser: none is downloaded. */
const browsers = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executablePath = process.env.CHROMIUM ?? browsers.find((path) => existsSync(path)) ?? "/usr/bin/chromium";

export default defineConfig({
  testDir: "tests",
  workers: 1,
  timeout: 180_000,
  expect: { timeout: 20_000 },
  reporter: [["list"]],
  use: {
    // Containers have neither a graphics card nor user namespaces.
    launchOptions: { executablePath, args: ["--enable-unsafe-swiftshader", "--no-sandbox"] },
    reducedMotion: "reduce",
    actionTimeout: 10_000,
    navigationTimeout: 10_000,
    trace: "off",
  },
  projects: [
    { name: "desktop", use: { viewport: { width: 1440, height: 900 } } },
    { name: "phone", use: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 } },
  ],
});
