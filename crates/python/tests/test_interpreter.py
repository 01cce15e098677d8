"""The interpreter goes on while something is computed, and Ctrl-C ends it."""

from __future__ import annotations

import subprocess
import sys
import threading

import numpy
import pytest

import joulepath

#: Plans over so rough and large a map that it takes minutes, and sends itself Ctrl-C soon after.
INTERRUPTED = """
import os, signal, threading
import joulepath, numpy
z = numpy.random.default_rng(1).uniform(0, 0.25, (2500, 2500))
planner = joulepath.Planner(joulepath.Map.from_array(z, 0.5))
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    planner.compare((5, 5), (1240, 1240))
    print("went on")
except KeyboardInterrupt:
    print("ended")
"""


def test_ctrl_c_ends_a_plan():
    done = subprocess.run([sys.executable, "-c", INTERRUPTED], check=False, capture_output=True, text=True, timeout=120)
    assert done.stdout.strip() == "ended", done.stderr


def test_other_threads_go_on_meanwhile(planner):
    ticks, planned = [], threading.Event()

    def count():
        while not planned.is_set():
            ticks.append(len(ticks))

    counter = threading.Thread(target=count)
    counter.start()
    planner.plan((3, 10), (27, 10))
    planned.set()
    counter.join()
    assert ticks


def test_plans_of_several_threads_are_those_of_one(planner):
    goals = [(27.0, y) for y in numpy.linspace(3.0, 17.0, 8)]
    alone = [planner.plan((3, 10), goal).energy_j for goal in goals]
    found = [0.0] * len(goals)

    def plan(index):
        found[index] = planner.plan((3, 10), goals[index]).energy_j

    threads = [threading.Thread(target=plan, args=(index,)) for index in range(len(goals))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone


def test_what_progress_raises_ends_the_work(simulated):
    def refuse(step, share):
        raise RuntimeError(f"no more of {step}")

    with pytest.raises(RuntimeError, match="no more of"):
        joulepath.diagnose(simulated.recording, progress=refuse)


def test_robots_and_errors_travel_to_other_processes():
    import pickle

    husky = joulepath.Robot.builtin("husky-a200").replace(mass_kg=97.0)
    assert pickle.loads(pickle.dumps(husky)) == husky
