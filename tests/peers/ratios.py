"""Ratios of what `run` measured, of the least of each kind of run: other processes only ever add to it."""

import json
import sys
from collections import defaultdict


def main() -> None:
    runs = defaultdict(list)
    with open(sys.argv[1]) as lines:
        for run in map(json.loads, lines):
            runs[run["cells_per_side"], run.get("bound"), run.get("plan")].append(run)

    def least(key: tuple, field: str) -> float:
        return min(run[field] for run in runs[key])

    print(f"{'side':>5} {'search':<22} {'CPU ratio':>9} {'memory':>7} {'CPU s':>7} {'plan ms':>8} {'warm ms':>8} {'MB':>6} {'expanded':>9}")
    for side in sorted({side for side, _, _ in runs}):
        peer = (side, None, None)
        cpu_s, mb = least(peer, "process_cpu_s"), least(peer, "peak_mb")
        imports_s = least(peer, "imports_cpu_s")
        print(f"{side:>5} {'MCP_Geometric':<22} {1:>9.2f} {1:>7.2f} {cpu_s:>7.3f} {'':>8} {'':>8} {mb:>6.0f} {'':>9}  imports {imports_s:.3f} s of it")
        for bound in sorted({bound for s, bound, _ in runs if s == side and bound}, reverse=True):
            cold, warm = (side, bound, "nothing at hand"), (side, bound, "everything at hand")
            print(
                f"{side:>5} {f'joulepath, bound {bound:g}':<22} {least(cold, 'process_cpu_s') / cpu_s:>9.2f}"
                f" {least(cold, 'peak_mb') / mb:>7.2f} {least(cold, 'process_cpu_s'):>7.3f} {least(cold, 'plan_ms'):>8.1f}"
                f" {least(warm, 'plan_ms'):>8.2f} {least(cold, 'peak_mb'):>6.0f} {runs[cold][0]['expanded']:>9}"
            )


if __name__ == "__main__":
    main()
