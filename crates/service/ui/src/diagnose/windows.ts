/** Times that charts and the map shade: the places of time that a report names, else the windows of its findings. */
import type { Difference, Report, Scope } from "./report";

export function shadedOf({ where, findings, trace }: Report): Difference[] {
  if (!trace || where.some(({ kind }) => kind === "time")) return where;
  return [...where, ...findings.flatMap(({ scope }) => (scope ? windowsOf(scope, trace.runs) : []))];
}

/** A window that sets in during one drive goes on through all that follow; one that ends there holds for all before. */
function windowsOf({ from_s, until_s, run }: Scope, runs: string[]): Difference[] {
  if (from_s === null && until_s === null) return [];
  const own = run === null ? null : runs.indexOf(run);
  return runs.flatMap((name, i) => {
    const isAfter = own !== null && i > own;
    const isBefore = own !== null && i < own;
    if ((isBefore && from_s !== null) || (isAfter && until_s !== null)) return [];
    const range = { quantity: "t_s", name, from: isAfter ? null : from_s, to: isBefore ? null : until_s };
    return [{ kind: "time" as const, statement: "", range, share_of_excess: 0 }];
  });
}
