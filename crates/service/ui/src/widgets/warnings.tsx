/** Doubts about a map or a path over it, a sentence each. */
import type { Warning } from "../api/maps";
import { sentence } from "../format";
import { Marked } from "./marked";

export function Warnings({ list, label }: { list: Warning[]; label: string }) {
  if (list.length === 0) return null;
  return (
    <ul class="warnings" aria-label={label}>
      {list.map(({ kind, detail }) => (
        <li key={kind}>
          <Marked text={sentence(detail)} />
        </li>
      ))}
    </ul>
  );
}
