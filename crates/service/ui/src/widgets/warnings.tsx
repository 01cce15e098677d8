/** Doubts about a map or a path over it, a sentence each. */
import type { Warning } from "../api/maps";

export function Warnings({ list, label }: { list: Warning[]; label: string }) {
  if (list.length === 0) return null;
  return (
    <ul class="warnings" aria-label={label}>
      {list.map(({ kind, detail }) => (
        <li key={kind}>{detail.charAt(0).toUpperCase() + detail.slice(1)}.</li>
      ))}
    </ul>
  );
}
