"""Writes small Parquet files whose times have every type that pandas, polars and pyarrow store, and Arrow's schema of durations.

    python write_times.py FOLDER

Every file holds the same four rows, 0.25 s apart from 1 700 000 000 s on; durations count from 10 s on.
"""

import datetime
import sys
from pathlib import Path

import pandas
import polars
import pyarrow
import pyarrow.parquet

FOLDER = Path(sys.argv[1])
PER_S = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
MOTION = {"v_left_mps": [0.5] * 4, "v_right_mps": [0.5] * 4, "power_w": [80.0, 81.0, 82.0, 83.0]}


def write(name, t_s, **options):
    columns = {"t_s": t_s} | {name: pyarrow.array(values) for name, values in MOTION.items()}
    pyarrow.parquet.write_table(pyarrow.table(columns), FOLDER / f"{name}.parquet", **options)


for unit, per_s in PER_S.items():
    # Whole seconds where the unit has no smaller ones.
    step = max(per_s // 4, 1)
    write(f"duration-{unit}", pyarrow.array([10 * per_s + step * row for row in range(4)], pyarrow.duration(unit)))
    stamps = [1_700_000_000 * per_s + step * row for row in range(4)]
    write(f"timestamp-{unit}", pyarrow.array(stamps, pyarrow.timestamp(unit)))
    if unit == "ns":
        write("timestamp-int96", pyarrow.array(stamps, pyarrow.timestamp(unit)), use_deprecated_int96_timestamps=True)
    if unit == "us":
        write("timestamp-v1", pyarrow.array(stamps, pyarrow.timestamp(unit, "UTC")), version="1.0")

times = [datetime.timedelta(seconds=10 + 0.25 * row) for row in range(4)]
pandas.DataFrame({"t_s": pandas.to_timedelta(times)} | MOTION).to_parquet(FOLDER / "pandas.parquet")
polars.DataFrame({"t_s": times} | MOTION).write_parquet(FOLDER / "polars.parquet")

fields = [pyarrow.field(unit, pyarrow.duration(unit)) for unit in PER_S] + [pyarrow.field("x", pyarrow.float64())]
schema = pyarrow.schema(fields)
pyarrow.parquet.write_table(schema.empty_table(), FOLDER / "schema.parquet")
metadata = pyarrow.parquet.read_metadata(FOLDER / "schema.parquet").metadata
(FOLDER / "durations.schema").write_bytes(metadata[b"ARROW:schema"] + b"\n")
(FOLDER / "schema.parquet").unlink()
