/** Failures as the service tells them: RFC 9457 problem documents. */

export interface FieldError {
  /** JSON pointer into the request. */
  pointer: string;
  detail: string;
}

export interface ProblemDocument {
  type: string;
  title: string;
  status: number;
  detail: string;
  errors?: FieldError[];
}

/** A failed request. */
export class Problem extends Error {
  constructor(readonly document: ProblemDocument) {
    super(document.detail);
  }

  /** Complaints about one field, by its JSON pointer. */
  at(pointer: string): string | undefined {
    return this.document.errors?.find((error) => error.pointer === pointer)?.detail;
  }
}

/** Anything thrown, as a problem that says what to do. */
export function problemOf(thrown: unknown): Problem {
  if (thrown instanceof Problem) return thrown;
  const detail = thrown instanceof Error ? thrown.message : String(thrown);
  return new Problem({ type: "page", title: "Something went wrong on this page", status: 0, detail });
}

/** The service did not answer at all. */
export function unreachable(): Problem {
  return new Problem({
    type: "unreachable",
    title: "The service does not answer",
    status: 0,
    detail: "Check that `joulepath serve` is running and that this machine can reach it, then try again.",
  });
}

/** A refused answer as a problem, whatever it was written in. */
export function refused(status: number, text: string): Problem {
  try {
    const document = JSON.parse(text) as ProblemDocument;
    if (typeof document.detail === "string") return new Problem(document);
  } catch {
    // Not a problem document: a proxy may have answered.
  }
  const detail = `The answer was ${status}${text ? `: ${text.slice(0, 200)}` : ""}. Try again, or look at the service's log.`;
  return new Problem({ type: "http", title: "The service refused", status, detail });
}
