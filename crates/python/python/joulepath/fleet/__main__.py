"""`python3 -m joulepath.fleet`, which `joulepath fleet` runs."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import joulepath

from . import Drive, Ways, calibrate, diagnose, matrix, prove, read_list, report
from .departures import FALSE_ALARM_RATE
from .example import Scale, simulate_fleet
from .matrix import BLOCK_SOURCES
from .prove import BLOCK_CASES

WRONG_INPUT = 2
"""Exit status of a question that cannot be answered as it stands, as of the whole command."""
SOME_FAILED = 1
"""Exit status where some of the fleet failed."""
INTERRUPTED = 130
"""Exit status after Ctrl-C."""


def main(words: list[str] | None = None) -> int:
    """Runs the command and returns its exit status."""
    arguments = _parser().parse_args(words)
    try:
        return arguments.run(arguments)
    except (joulepath.Error, ValueError) as error:
        print(f"joulepath fleet: {error}", file=sys.stderr)
        return WRONG_INPUT
    except OSError as error:
        print(f"joulepath fleet: {error}", file=sys.stderr)
        return SOME_FAILED
    except KeyboardInterrupt:
        print("joulepath fleet: interrupted; ask again to go on from here", file=sys.stderr)
        return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="joulepath fleet", description="Ask a fleet's recordings on a Ray cluster, and see which robots differ.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, words in (("diagnose", "Diagnose every recording"), ("calibrate", "Fit the robot to every recording by itself")):
        command = _command(commands, name, words, _ask)
        command.set_defaults(kind=name)
        command.add_argument("--recording", nargs="+", default=[], metavar="PATH", help="files, folders, patterns or s3:// addresses, .../UNIT/DATE...")
        command.add_argument("--list", metavar="FILE", help="table with path, unit and date of each recording, in place of --recording")
        command.add_argument("--columns", "--map", dest="columns", metavar="MAP", help="file or built-in name of a map of log columns or topics")
        if name == "diagnose":
            command.add_argument("--reference", nargs="+", default=[], metavar="PATH", help="drives known to be healthy, of the same units")
            command.add_argument("--ruled-out", nargs="+", metavar="MECHANISM", help="mechanisms that are known not to act")
        _robot_and_cluster(command)
    command = _command(commands, "matrix", "Energy, time and length between many places", _matrix)
    command.add_argument("--map", required=True, help="map file or s3:// address")
    command.add_argument("--places", required=True, metavar="FILE", help="JSON list of [x_m, y_m] or [x_m, y_m, heading_rad]: sources, and targets")
    command.add_argument("--targets", metavar="FILE", help="the same of targets, where they are others")
    command.add_argument("--block-sources", type=int, default=BLOCK_SOURCES, metavar="N", help="sources of one task [default: %(default)s]")
    command.add_argument("--out", metavar="FILE", help="where to write the matrix as JSON, instead of printing it")
    _robot_and_cluster(command)
    command = _command(commands, "prove", "Conceal effects in thousands of drives, and score what is found", _prove)
    command.add_argument("--cases", type=int, required=True, metavar="N")
    command.add_argument("--seed", type=int, default=1, metavar="S")
    command.add_argument("--block-cases", type=int, default=BLOCK_CASES, metavar="N", help="cases of one task [default: %(default)s]")
    _robot_and_cluster(command)
    command = _command(commands, "report", "Tell which robots differ from their fleet, by what, and since when", _report)
    command.add_argument("--storage", required=True, metavar="PLACE", help="folder or s3:// address of the results")
    command.add_argument("--out", metavar="DIR", help="folder for report.json, units.csv, parameters.csv and report.html")
    command.add_argument(
        "--false-alarm-rate", type=float, default=FALSE_ALARM_RATE, metavar="P", help="chance that a healthy fleet is given a name [default: %(default)s]"
    )
    command = _command(commands, "example", "Simulate a fleet of which some robots fall ill", _example)
    command.add_argument("--out", required=True, metavar="DIR", help="folder for the recordings and truth.json")
    for name, kind, default in (("units", int, Scale.units), ("ill", int, Scale.ill), ("weeks", int, Scale.weeks), ("duration-s", float, Scale.duration_s)):
        command.add_argument(f"--{name}", type=kind, default=default, help="[default: %(default)s]")
    command.add_argument("--seed", type=int, default=1, metavar="S")
    return parser


def _command(commands: Any, name: str, words: str, run: Any) -> argparse.ArgumentParser:
    command = commands.add_parser(name, help=words, description=words + ".")
    command.set_defaults(run=run)
    command.add_argument("--json", action="store_true", help="print the answer as a JSON document")
    return command


def _robot_and_cluster(command: argparse.ArgumentParser) -> None:
    command.add_argument("--robot", default="husky-a200", help="name of a built-in robot, or a robot file [default: %(default)s]")
    command.add_argument("--storage", required=True, metavar="PLACE", help="folder or s3:// address where results are kept; may be a service's --store")
    command.add_argument("--address", help="address of the Ray cluster [default: RAY_ADDRESS, else a Ray of this machine for this call]")
    command.add_argument("--cores-per-task", type=int, default=1, metavar="N", help="[default: %(default)s]")
    command.add_argument("--retries", type=int, default=Ways.retries, metavar="N", help="how often a task is repeated whose machine died [default: %(default)s]")
    command.add_argument(
        "--task-timeout-s", type=float, default=Ways.task_timeout_s, metavar="S", help="most time of one task, counted as failed beyond it [default: %(default)s]"
    )


def _ways(arguments: argparse.Namespace) -> Ways:
    return Ways(arguments.address, arguments.cores_per_task, arguments.retries, task_timeout_s=arguments.task_timeout_s)


def _ask(arguments: argparse.Namespace) -> int:
    paths: list[str | Drive] = [*arguments.recording]
    if arguments.list:
        paths += read_list(arguments.list)
    columns = json.loads(Path(arguments.columns).read_text()) if arguments.columns and Path(arguments.columns).exists() else arguments.columns
    shared = {"robot": arguments.robot, "storage": arguments.storage, "map": columns, "ways": _ways(arguments), "progress": sys.stderr.isatty()}
    if arguments.kind == "diagnose":
        run = diagnose(paths, healthy=arguments.reference, ruled_out=arguments.ruled_out, **shared)
    else:
        run = calibrate(paths, **shared)
    _print(run, arguments.json)
    return SOME_FAILED if run.failed else 0


def _matrix(arguments: argparse.Namespace) -> int:
    places = json.loads(Path(arguments.places).read_text())
    targets = json.loads(Path(arguments.targets).read_text()) if arguments.targets else None
    found = matrix(
        arguments.map,
        places,
        targets,
        robot=arguments.robot,
        storage=arguments.storage,
        block_sources=arguments.block_sources,
        ways=_ways(arguments),
        progress=sys.stderr.isatty(),
    )
    if arguments.out:
        Path(arguments.out).write_text(json.dumps(found.to_dict(), allow_nan=False))
    _print(found, arguments.json or not arguments.out)
    return SOME_FAILED if found.failed else 0


def _prove(arguments: argparse.Namespace) -> int:
    found = prove(
        arguments.cases,
        seed=arguments.seed,
        robot=arguments.robot,
        storage=arguments.storage,
        block_cases=arguments.block_cases,
        ways=_ways(arguments),
        progress=sys.stderr.isatty(),
    )
    _print(found, arguments.json)
    return SOME_FAILED if found.failed else 0


def _report(arguments: argparse.Namespace) -> int:
    found = report(arguments.storage, false_alarm_rate=arguments.false_alarm_rate)
    if arguments.out:
        found.write(arguments.out)
    _print(found, arguments.json)
    return 0


def _example(arguments: argparse.Namespace) -> int:
    scale = Scale(arguments.units, arguments.ill, arguments.weeks, arguments.duration_s)

    def tell(done: int, of: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{done} of {of} drives", end="\n" if done == of else "", file=sys.stderr)

    folder = simulate_fleet(arguments.out, scale, seed=arguments.seed, progress=tell)
    said = f"{folder}: {scale.units} units, what is wrong with {scale.ill} is in truth.json"
    print(json.dumps({"folder": str(folder)}) if arguments.json else said)
    return 0


def _print(answer: Any, as_json: bool) -> None:
    print(json.dumps(answer.to_dict(), allow_nan=False) if as_json else answer)


if __name__ == "__main__":
    sys.exit(main())
