/** The token that a guarded service wants; kept until the browser's tab is closed, and never part of a link. */
import { signal } from "@preact/signals";

const STORED = "joulepath-token";

/** Whether the service has asked for a token since the last one was given. */
export const isWanted = signal(false);

/** Whether it was refused although one had been given. */
export const isRefused = signal(false);

export function give(token: string): void {
  sessionStorage.setItem(STORED, token.trim());
  isWanted.value = false;
}

/** What every request carries. */
export function authorization(): Record<string, string> {
  const token = sessionStorage.getItem(STORED);
  return token ? { authorization: `Bearer ${token}` } : {};
}

/** Looks at an answer's status: 401 asks for a token. */
export function noticed(status: number): void {
  if (status !== 401) return;
  isRefused.value = sessionStorage.getItem(STORED) !== null;
  isWanted.value = true;
}
