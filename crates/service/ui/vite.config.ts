import { defineConfig } from "vite";

/** Where `joulepath serve` listens while the page is worked on. */
const service = process.env.JOULEPATH_SERVICE ?? "http://127.0.0.1:8080";

export default defineConfig({
  base: "/",
  build: {
    target: "es2022",
    // One flat folder, so that the service needs one route for it.
    assetsDir: "page",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
  },
  server: { proxy: { "/v1": service, "/sample-map.tif": service, "/openapi.json": service } },
});
