/** Long work: started, followed by server-sent events, called off. */
import { ask } from "./ask";
import { unreachable, type ProblemDocument } from "./problem";

export interface Job<Result> {
  id: string;
  kind: string;
  state: "queued" | "running" | "done" | "failed" | "cancelled";
  progress: { step: string; fraction: number | null };
  result?: Result;
  problem?: ProblemDocument;
}

export const startDiagnosis = <Result>(question: { robot: string; recordings: string[]; reference: string[] }) =>
  ask<Job<Result>>("/v1/diagnose", { json: question });

export const readJob = <Result>(id: string) => ask<Job<Result>>(`/v1/jobs/${id}`);
export const cancelJob = <Result>(id: string) => ask<Job<Result>>(`/v1/jobs/${id}`, { method: "DELETE" });

/** Tells every change of a job until it ends. Returns what stops the telling. */
export function followJob<Result>(id: string, tell: (job: Job<Result>) => void, fail: (problem: Error) => void): () => void {
  const events = new EventSource(`/v1/jobs/${id}/events`);
  const told = (event: MessageEvent<string>) => {
    const job = JSON.parse(event.data) as Job<Result>;
    tell(job);
    if (job.state !== "queued" && job.state !== "running") events.close();
  };
  for (const name of ["progress", "done", "failed", "cancelled"]) events.addEventListener(name, told as EventListener);
  // The browser comes back by itself after a break; what it gives up on does not.
  events.onerror = () => {
    if (events.readyState === EventSource.CLOSED) fail(unreachable());
  };
  return () => events.close();
}
