"""The long trial of fleets: one node against two, a killed worker and a killed node, and the example fleet of which three robots are ill.

    python trial.py OUT [--recordings 1000] [--kind diagnose] [--seed 2026] [--only speed|fleet|alarms]

Prints a line for each figure and ends with 1 where one is not reached.
"""

import argparse
import json
import os
import signal
import sys
import time
from pathlib import Path

from joulepath import fleet
from joulepath.fleet.departures import find_departures
from joulepath.fleet.example import Scale, simulate_fleet
from nodes import OTHER, Cluster
from test_departures import healthy

WEEKS = 4
LEAST_SPEEDUP = 1.8
HEALTHY_FLEETS, ALARM_RATE = 200, 0.05


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--recordings", type=int, default=1000)
    parser.add_argument("--kind", choices=["diagnose", "calibrate"], default="diagnose")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--only", choices=["speed", "fleet", "alarms"])
    arguments = parser.parse_args()
    if arguments.only == "alarms":
        sys.exit(0 if alarms() else 1)
    cluster = Cluster()
    reached = []
    try:
        cluster.connect()
        if arguments.only != "fleet":
            reached += speed_and_losses(cluster, arguments)
        if arguments.only != "speed":
            reached += example(arguments)
    finally:
        cluster.end()
    sys.exit(0 if all(reached) else 1)


def speed_and_losses(cluster, arguments):
    """The same recordings on one node, on two, and on two of which a worker and then a node are killed."""
    scale = Scale(units=-(-arguments.recordings // WEEKS), ill=0, weeks=WEEKS)
    logs = simulate_fleet(arguments.out / "logs", scale, seed=1)
    paths = sorted(logs.glob("*/*.csv"))[: arguments.recordings]
    ask = getattr(fleet, arguments.kind)

    def timed(name, progress=False):
        began_s, load = time.monotonic(), os.getloadavg()[0]
        run = ask([str(path) for path in paths], storage=arguments.out / name, progress=progress)
        spent_s = time.monotonic() - began_s
        at_work = sum(one["spent_s"] or 0.0 for one in run.outcomes) / (spent_s * len(cluster.nodes))
        print(f"{name}: {run.counts} in {spent_s:.1f} s, nodes at work {100 * at_work:.0f} % of it (load of the machine before: {load:.1f})", flush=True)
        return run, spent_s

    # Workers are started, and programs and files are in memory, before time is taken.
    ask(str(paths[0]), storage=arguments.out / "warm-1")
    one, one_s = timed("one-node")
    cluster.add()
    ask([str(path) for path in paths[:4]], storage=arguments.out / "warm-2")
    two, two_s = timed("two-nodes")
    killed = []

    def kill(step, share):
        if share >= 1 / 3 and not killed:
            killed.append(kill_worker(cluster))
        if share >= 2 / 3 and len(killed) == 1:
            cluster.kill(OTHER)
            killed.append(OTHER)

    rough, _ = timed("two-nodes-killed", kill)
    same = [outcomes(run) == outcomes(one) for run in (two, rough)]
    whole = [len(list((arguments.out / name / "reports").iterdir())) == len(paths) for name in ("one-node", "two-nodes", "two-nodes-killed")]
    print(f"two nodes are {one_s / two_s:.2f} times as fast as one")
    print(f"killed: worker {killed[0]}, node {killed[1]}; same outcomes {all(same)}; one report for each recording {all(whole)}", flush=True)
    return [one_s / two_s >= LEAST_SPEEDUP, *same, *whole, one.counts.done == len(paths)]


def alarms():
    """How often a fleet of which nothing is wrong is given a name, against how often it may."""
    named = sum(bool(find_departures(healthy(8, seed=seed), ALARM_RATE).named) for seed in range(HEALTHY_FLEETS))
    print(f"{named} of {HEALTHY_FLEETS} healthy fleets of 8 robots were given a name at a false-alarm rate of {ALARM_RATE}")
    return named <= ALARM_RATE * HEALTHY_FLEETS


def outcomes(run):
    """What became of every recording, without how long it took."""
    return [(one["path"], one["state"], one["recording_id"], one["job_id"]) for one in run.outcomes]


def kill_worker(cluster):
    """Kills a worker that is at work on one of the cluster's nodes, and returns its id."""
    groups = {node.process.pid for node in cluster.nodes.values()}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and b"ray::report_on" in (entry / "cmdline").read_bytes() and os.getsid(int(entry.name)) in groups:
                os.kill(int(entry.name), signal.SIGKILL)
                return int(entry.name)
        except (OSError, ProcessLookupError):
            continue
    raise AssertionError("no worker is at work")


def example(arguments):
    """Whether the ill robots of a fleet that nothing was tuned on are named, and no other."""
    logs = simulate_fleet(arguments.out / f"fleet-{arguments.seed}", seed=arguments.seed)
    storage = arguments.out / f"fleet-{arguments.seed}-store"
    print(fleet.calibrate(logs, storage=storage))
    print(fleet.diagnose(logs, storage=storage))
    report = fleet.report(storage)
    report.write(arguments.out / f"fleet-{arguments.seed}-report")
    ill = {one["unit"]: one for one in json.loads((logs / "truth.json").read_text())["ill"]}
    print(report)
    for unit, one in ill.items():
        print(f"  true: {unit}: {one['effect']} of {one['strength']} since {one['since']}")
    print(f"{len(set(report.named) & set(ill))} of {len(ill)} ill robots named, {len(set(report.named) - set(ill))} false alarms")
    return [set(report.named) == set(ill)]


if __name__ == "__main__":
    main()
