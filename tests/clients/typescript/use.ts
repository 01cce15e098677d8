// Uploads a map, plans on it and diagnoses a recording with the generated client: node use.js URL MAP RECORDING.
import { readFileSync } from "node:fs";
import createClient from "openapi-fetch";
import type { components, paths } from "./schema.js";

type PlanAnswer = components["schemas"]["PlanAnswer"];

const [url, mapFile, recordingFile] = process.argv.slice(2);
if (url === undefined || mapFile === undefined || recordingFile === undefined) throw new Error("URL MAP RECORDING");
const client = createClient<paths>({ baseUrl: url });

function taken<T>(answer: { data?: T; error?: unknown; response: Response }): T {
  if (answer.data === undefined) throw new Error(`${answer.response.status}: ${JSON.stringify(answer.error)}`);
  return answer.data;
}

function check(holds: boolean, claim: string): void {
  if (!holds) throw new Error(`this does not hold: ${claim}`);
}

const body: components["schemas"]["MapFile"] = JSON.parse(readFileSync(mapFile, "utf8"));
const map = taken(await client.POST("/v1/maps", { body }));
const plan = taken(
  await client.POST("/v1/plan", {
    body: { map_id: map.id, robot: "husky-a200", start: { x_m: 4, y_m: 8 }, goal: { x_m: 20, y_m: 12 } },
  }),
) as PlanAnswer;
check(plan.poses.length > 1 && plan.energy_j > 0, "a path has poses and takes energy");

const recording = taken(
  await client.POST("/v1/recordings", {
    body: readFileSync(recordingFile, "utf8"),
    bodySerializer: (text) => text as string,
    headers: { "content-type": "text/csv" },
  }),
);
const started = taken(
  await client.POST("/v1/diagnose", { body: { robot: "husky-a200", recordings: [recording.id] } }),
);
const params = { path: { id: started.id } };
// The events end with the job.
taken(await client.GET("/v1/jobs/{id}/events", { params, parseAs: "text" }));
const job = taken(await client.GET("/v1/jobs/{id}", { params }));
check(job.state === "done", `the job ends as done, but is ${job.state}`);
console.log(`TypeScript: ${plan.energy_j.toFixed(0)} J over ${plan.distance_m.toFixed(1)} m, and a diagnosis`);
