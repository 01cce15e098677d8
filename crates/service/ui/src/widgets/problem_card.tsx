/** A failure: what, why, and what to do. */
import type { Problem } from "../api/problem";

export function ProblemCard({ problem, retry, close }: { problem: Problem; retry?: () => void; close?: () => void }) {
  const { title, detail, errors = [] } = problem.document;
  const others = errors.filter((error) => error.detail !== detail);
  return (
    <div class="problem" role="alert">
      <strong>{title}</strong>
      <p>{sentence(detail)}</p>
      {others.length > 0 && (
        <ul>
          {others.map((error) => (
            <li key={error.pointer}>
              <code>{error.pointer}</code> {error.detail}
            </li>
          ))}
        </ul>
      )}
      {(retry || close) && (
        <p class="problem-acts">
          {retry && (
            <button type="button" onClick={retry}>
              Try again
            </button>
          )}
          {close && (
            <button type="button" onClick={close}>
              Close
            </button>
          )}
        </p>
      )}
    </div>
  );
}

/** The service writes details without a capital and a stop. */
const sentence = (text: string) => text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");
