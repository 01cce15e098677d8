"""Figures of the Python package: size, import, overhead of a call, tables, power over arrays, and Ctrl-C. Each the least of several.

`tests/python_package/run --measure` runs it against the wheel; `JOULEPATH` names the command that tables are compared with.
"""

from __future__ import annotations

import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

import joulepath

HERE = pathlib.Path(__file__).parent
REPEATS = 9


def least_s(call, repeats: int = REPEATS) -> float:
    """Least time of a call, which other work on the machine does not lengthen [s]."""
    taken_s = []
    for _ in range(repeats):
        began_s = time.perf_counter()
        call()
        taken_s.append(time.perf_counter() - began_s)
    return min(taken_s)


def size(wheel: str) -> None:
    print(f"wheel                {os.path.getsize(wheel) / 1e6:.1f} MB")


def importing() -> None:
    timed = "import time; b = time.perf_counter(); import joulepath; print(time.perf_counter() - b)"
    taken_s = [float(subprocess.check_output([sys.executable, "-c", timed])) for _ in range(REPEATS)]
    print(f"import               {1e3 * min(taken_s):.0f} ms")


def overhead() -> None:
    y_m, x_m = numpy.mgrid[0:40, 0:60] * 0.5
    z_m = 4.0 * numpy.exp(-((x_m - 15.0) ** 2 + (y_m - 10.0) ** 2) / 30.0)
    planner = joulepath.Planner(joulepath.Map.from_array(z_m, 0.5))
    start, goal = (3.0, 10.0, 0.0), (27.0, 10.0)
    planner.plan(start, goal)
    beyond_ms = []
    for _ in range(300):
        began_s = time.perf_counter()
        path = planner.plan(start, goal, refine=False)
        path.energy_j, path.poses["x_m"]
        beyond_ms.append(1e3 * (time.perf_counter() - began_s - path._native.answered_s))
    print(f"plan beyond Rust     {min(beyond_ms):.2f} ms ({path.poses.rows} poses, columns included)")


def tables() -> None:
    import pandas

    rows = 1_000_000
    t_s = numpy.arange(rows) * 0.1
    left_mps, right_mps = 0.4 + 0.2 * numpy.sin(t_s / 7), 0.4 + 0.2 * numpy.cos(t_s / 5)
    table = {"t_s": t_s, "v_left_mps": left_mps, "v_right_mps": right_mps, "pitch_rad": 0.1 * numpy.sin(t_s / 90)}
    frame = pandas.DataFrame({**table, "power_w": 80 + 40 * numpy.sin(t_s / 7)})
    ours_s = least_s(lambda: joulepath.predict(frame), 3)
    print(f"1 M rows of pandas   {ours_s:.2f} s to predicted power")
    command = os.environ.get("JOULEPATH")
    if command is None:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "drive.parquet"
        frame.to_parquet(path, index=False)
        arguments = [command, "predict", "--robot", "husky-a200", "--recording", str(path), "--json"]
        theirs_s = least_s(lambda: subprocess.check_output(arguments, stderr=subprocess.DEVNULL), 3)
    print(f"the command, Parquet {theirs_s:.2f} s: {ours_s / theirs_s:.2f} times")


def moments() -> None:
    spec = importlib.util.spec_from_file_location("numpy_power", HERE / "tests" / "numpy_power.py")
    peer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(peer)
    random, count = numpy.random.default_rng(5), 1_000_000
    speed_mps, yaw_rate_radps = random.uniform(-1, 1, count), random.uniform(-1.5, 1.5, count)
    pitch_rad, roll_rad = random.uniform(-0.4, 0.4, count), random.uniform(-0.3, 0.3, count)
    husky = joulepath.Robot.builtin("husky-a200")
    document, inputs = husky.to_dict(), (speed_mps, yaw_rate_radps, pitch_rad, roll_rad)
    ours_s = least_s(lambda: joulepath.power(husky, *inputs, surface="marble"))
    theirs_s = least_s(lambda: peer.power_w(document, "marble", *inputs))
    threads = os.environ.get("RAYON_NUM_THREADS", "all")
    print(
        f"power of 1 M moments {1e3 * ours_s:.0f} ms ({threads} threads); numpy {1e3 * theirs_s:.0f} ms: {theirs_s / ours_s:.1f} times as long"
    )


INTERRUPTED = """
import os, signal, threading, time
import joulepath, numpy
z = numpy.random.default_rng(1).uniform(0, 0.25, (2500, 2500))
planner = joulepath.Planner(joulepath.Map.from_array(z, 0.5))
sent = []
def send():
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(1.0, send).start()
try:
    planner.compare((5, 5), (1240, 1240))
    print("nan")
except KeyboardInterrupt:
    print(time.perf_counter() - sent[0])
"""


def interrupting() -> None:
    taken_s = [float(subprocess.check_output([sys.executable, "-c", INTERRUPTED])) for _ in range(3)]
    print(f"Ctrl-C to its end    {1e3 * max(taken_s):.0f} ms at most of {len(taken_s)}")


if __name__ == "__main__":
    size(sys.argv[1])
    importing()
    overhead()
    tables()
    moments()
    interrupting()
