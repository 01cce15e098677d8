"""The `joulepath` command: where it is, and calling it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from .errors import FleetError

AT_FAULT = (2, 3)
"""Exit statuses that say that the question is at fault: asked again, it fails again. Any other may be the machine's."""


def joulepath_command() -> list[str]:
    """Returns the command line that begins every call of the `joulepath` command: that of the variable `JOULEPATH`, or this package's own.

    Raises a `FleetError` of type `no-command` where the variable names no program.
    """
    named = os.environ.get("JOULEPATH")
    if named is None:
        return [sys.executable, "-m", "joulepath"]
    found = shutil.which(named)
    if found is None:
        raise FleetError(
            "no-command", f"JOULEPATH names `{named}`, which is no program: install it on every machine of the cluster, or unset JOULEPATH"
        )
    return [found]


def called(words: list[str | Path]) -> str:
    """Returns what the command prints.

    Raises a [`FleetError`] with its own words where the question is at fault, and `OSError` where the command died.
    """
    done = subprocess.run([*joulepath_command(), *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.strip().removeprefix("joulepath: ")
    if done.returncode in AT_FAULT:
        raise FleetError("invalid-request", said)
    raise OSError(f"`joulepath {words[0]}` ended with status {done.returncode}: {said}")


def robot_words(robot: str | dict[str, Any], room: Path) -> list[str]:
    """The words that tell the command of a robot; one that is a document goes through a file in `room`."""
    if isinstance(robot, str):
        return ["--robot", robot]
    file = room / "robot.json"
    file.write_text(json.dumps(robot))
    return ["--robot", str(file)]
