/** Long work: started, followed by server-sent events, called off. */
import { effect, type Signal } from "@preact/signals";
import { ask, send } from "./ask";
import { eventsOf } from "./events";
import { Problem, problemOf, type ProblemDocument } from "./problem";
import type { Robot } from "./robots";

export interface Job<Result> {
  id: string;
  kind: string;
  state: "queued" | "running" | "done" | "failed" | "cancelled";
  progress: { step: string; fraction: number | null };
  result?: Result;
  problem?: ProblemDocument;
}

/** A job of which only the id may be known yet. */
export type KnownJob<Result> = Partial<Job<Result>> & Pick<Job<Result>, "id" | "state">;

export const startCalibration = <Result>(question: { robot: string | Robot; recordings: string[]; despite?: string[] }) =>
  ask<Job<Result>>("/v1/calibrate", { json: question });

export const startDiagnosis = <Result>(question: { robot: string | Robot; recordings: string[]; reference: string[] }) =>
  ask<Job<Result>>("/v1/diagnose", { json: question });

export const readJob = <Result>(id: string) => ask<Job<Result>>(`/v1/jobs/${id}`);
export const cancelJob = <Result>(id: string) => ask<Job<Result>>(`/v1/jobs/${id}`, { method: "DELETE" });

/** Pause before a broken stream of events is asked for again [ms]. */
const BACK_MS = 1000;
/** So often in a row before the service is taken to be gone. */
const MOST_BREAKS = 5;

const isOver = ({ state }: Job<unknown>) => state !== "queued" && state !== "running";

/** Tells every change of a job until it ends. Returns what stops the telling. */
export function followJob<Result>(id: string, tell: (job: Job<Result>) => void, fail: (thrown: unknown) => void): () => void {
  const controller = new AbortController();
  const { signal } = controller;
  const follow = async () => {
    let [seen, breaks] = ["", 0];
    while (!signal.aborted) {
      try {
        const headers: Record<string, string> = seen ? { "last-event-id": seen } : {};
        const response = await send(`/v1/jobs/${id}/events`, { accept: "text/event-stream", headers, signal });
        if (response.status === 204 || !response.body) return;
        for await (const event of eventsOf(response.body)) {
          [seen, breaks] = [event.id, 0];
          const job = JSON.parse(event.data) as Job<Result>;
          tell(job);
          if (isOver(job)) return;
        }
      } catch (thrown) {
        if (signal.aborted) return;
        breaks += 1;
        if (breaks >= MOST_BREAKS || (thrown instanceof Problem && thrown.document.status >= 400)) return fail(thrown);
      }
      await new Promise((resolve) => setTimeout(resolve, BACK_MS));
    }
  };
  void follow();
  return () => controller.abort();
}

/** Begins to follow whichever job a signal holds, until it ends. */
export function follow<Result>(
  job: Signal<KnownJob<Result> | null>,
  problem: Signal<Problem | null>,
  done: (result: Result) => void,
): void {
  let followed = "";
  let stop = () => {};
  effect(() => {
    const { id = "", state } = job.value ?? {};
    if (id === followed || (state && state !== "queued" && state !== "running")) return;
    stop();
    followed = id;
    if (!id) return;
    const told = (now: Job<Result>) => {
      if (job.peek()?.id === id) job.value = now;
      if (now.state === "done" && now.result) done(now.result);
    };
    // The events of a job that is not there fail without a word; asking for it says why.
    readJob<Result>(id).then(
      (now) => {
        told(now);
        if (now.state === "queued" || now.state === "running")
          stop = followJob<Result>(id, told, (thrown) => (problem.value = problemOf(thrown)));
      },
      (thrown) => {
        problem.value = problemOf(thrown);
        job.value = null;
      },
    );
  });
}
