/** Requests to the service. */
import { refused, unreachable } from "./problem";
import { authorization, noticed } from "./token";

/** What a request may carry. */
export interface Asking {
  method?: string;
  /** Sent as JSON. */
  json?: unknown;
  /** Sent as they are. */
  bytes?: Blob;
  accept?: string;
  /** More header fields. */
  headers?: Record<string, string>;
  signal?: AbortSignal;
}

/** Sends a request; whatever is not a success is thrown as a `Problem`. */
export async function send(path: string, asking: Asking = {}): Promise<Response> {
  const headers: Record<string, string> = { accept: asking.accept ?? "application/json", ...authorization(), ...asking.headers };
  const init: RequestInit = { method: asking.method ?? "GET", headers };
  if (asking.signal) init.signal = asking.signal;
  if (asking.json !== undefined) {
    headers["content-type"] = "application/json";
    init.body = JSON.stringify(asking.json);
    init.method = asking.method ?? "POST";
  }
  if (asking.bytes !== undefined) {
    init.body = asking.bytes;
    init.method = asking.method ?? "POST";
  }
  let response: Response;
  try {
    response = await fetch(path, init);
  } catch (thrown) {
    if (asking.signal?.aborted) throw thrown;
    throw unreachable();
  }
  noticed(response.status);
  if (!response.ok) throw refused(response.status, await response.text());
  return response;
}

/** Sends a request and reads JSON. */
export async function ask<T>(path: string, asking: Asking = {}): Promise<T> {
  return (await (await send(path, asking)).json()) as T;
}

/** Whether a request was given up by the page itself. */
export function isAbort(thrown: unknown): boolean {
  return thrown instanceof DOMException && thrown.name === "AbortError";
}
