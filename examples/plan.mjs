// Store a map, plan over it, print the energy: node examples/plan.mjs MAP.tif [SERVICE]
import { readFile } from "node:fs/promises";
const [file, service = "http://localhost:8080"] = process.argv.slice(2);
const post = async (path, body, type = "application/json") =>
  (await fetch(service + path, { method: "POST", body: type === "application/json" ? JSON.stringify(body) : body, headers: { "content-type": type } })).json();
const stored = await post("/v1/maps", await readFile(file), "image/tiff");
const [x_m, y_m] = stored.origin_m;
const question = { map_id: stored.id, robot: "husky-a200-field", start: { x_m: x_m + 40, y_m: y_m + 40 }, goal: { x_m: x_m + 90, y_m: y_m + 80 } };
const path = await post("/v1/plan", question);
console.log(`${(path.energy_j / 1e3).toFixed(1)} kJ over ${path.distance_m.toFixed(0)} m, 95 % of [${path.energy_interval_j.map((j) => (j / 1e3).toFixed(1)).join(", ")}] kJ`);
