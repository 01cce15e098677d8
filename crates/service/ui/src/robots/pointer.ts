/** Reading and changing a document by JSON pointers (RFC 6901). */

const parts = (pointer: string) =>
  pointer
    .split("/")
    .slice(1)
    .map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~"));

/** A name as part of a pointer. */
export const escaped = (name: string) => name.replaceAll("~", "~0").replaceAll("/", "~1");

type Branch = Record<string, unknown>;

export function read(document: unknown, pointer: string): unknown {
  return parts(pointer).reduce<unknown>((at, part) => (at !== null && typeof at === "object" ? (at as Branch)[part] : undefined), document);
}

/** A copy with another value; `undefined` takes the field out. */
export function changed<T>(document: T, pointer: string, value: unknown): T {
  const copy = structuredClone(document);
  const names = parts(pointer);
  const last = names.pop();
  if (last === undefined) return copy;
  let at = copy as Branch;
  for (const name of names) {
    if (at[name] === null || typeof at[name] !== "object") at[name] = {};
    at = at[name] as Branch;
  }
  if (value === undefined) delete at[last];
  else at[last] = value;
  return copy;
}
