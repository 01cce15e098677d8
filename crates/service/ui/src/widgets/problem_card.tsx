/** A failure: what, why, and what to do. */
import type { Problem } from "../api/problem";
import { sentence } from "../format";
import { Marked } from "./marked";

interface Props {
  problem: Problem;
  retry?: () => void;
  /** What trying again does, where it is not the same question. */
  retryName?: string;
  close?: () => void;
}

export function ProblemCard({ problem, retry, retryName = "Try again", close }: Props) {
  const { title, detail, errors = [] } = problem.document;
  const others = errors.filter((error) => error.detail !== detail);
  return (
    <div class="problem" role="alert">
      <strong>{title}</strong>
      <p>
        <Marked text={sentence(detail)} />
      </p>
      {others.length > 0 && (
        <ul>
          {others.map((error) => (
            <li key={error.pointer}>
              <code>{error.pointer}</code> <Marked text={error.detail} />
            </li>
          ))}
        </ul>
      )}
      {(retry || close) && (
        <p class="problem-acts">
          {retry && (
            <button type="button" onClick={retry}>
              {retryName}
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
