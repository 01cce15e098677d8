"""A least-cost path by scikit-image's MCP_Geometric over a map mirrored to a side, in a process of its own, and what it took, as JSON.

    mcp_geometric.py MAP.tif SIDE
"""

import time

BEGAN_S = time.perf_counter()

import json
import logging
import resource
import sys

import numpy as np
import tifffile
from skimage.graph import MCP_Geometric

IMPORTS_CPU_S = time.process_time()

# Of a Husky on marble: joules per metre on level ground, and how much dearer a metre is per unit of slope. It asks for an array of
# costs per cell, which can know neither headings nor whether a slope is climbed or descended.
LEVEL_J_PER_M = 95.0
PER_SLOPE = 3.0


def main() -> None:
    path, side = sys.argv[1], int(sys.argv[2])
    # It complains of the map's value for unknown ground, which no cell has.
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)
    # Rows from the south, as the planner mirrors them.
    tile_m = tifffile.imread(path).astype(float)[::-1]
    rows, columns = (np.pad(np.arange(n), (0, side), mode="symmetric")[:side] for n in tile_m.shape)
    height_m = tile_m[np.ix_(rows, columns)]
    north, east = np.gradient(height_m)
    cost_j_per_m = LEVEL_J_PER_M * (1.0 + PER_SLOPE * np.hypot(north, east))
    start, goal = ((int(0.12 * side), int(0.1 * side)), (int(0.88 * side), int(0.9 * side)))
    search = MCP_Geometric(cost_j_per_m)
    search.find_costs([start], [goal])
    cells = len(search.traceback(goal))
    report = {
        "cells_per_side": side,
        "cells_of_path": cells,
        "process_cpu_s": time.process_time(),
        "imports_cpu_s": IMPORTS_CPU_S,
        "process_s": time.perf_counter() - BEGAN_S,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    print(json.dumps(report))


if __name__ == "__main__":
    main()
