"""What is computed of one recording: by the `joulepath` command."""

from __future__ import annotations

import functools
import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from .command import joulepath_command
from .question import Question, Unanswerable


@functools.cache
def version() -> str:
    """The version of joulepath that computes, on which its results depend."""
    done = subprocess.run([*joulepath_command(), "--version"], capture_output=True, text=True, check=True)
    return done.stdout.split()[1]


def answer(question: Question, recording: Path, healthy: list[Path]) -> dict[str, Any]:
    """Returns the document that the HTTP API's job of the question has as its result.

    Raises [`Unanswerable`] where the recording or the robot is at fault.
    """
    with tempfile.TemporaryDirectory(prefix="joulepath-fleet-") as room:
        robot = question.robot
        if not isinstance(robot, str):
            file = Path(room, "robot.json")
            file.write_text(json.dumps(robot))
            robot = str(file)
        command = [*joulepath_command(), question.kind, "--robot", robot, "--json", "--recording", str(recording), "--out", str(Path(room, "out"))]
        if healthy:
            command += ["--reference", *map(str, healthy)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "RAYON_NUM_THREADS": "1"})
    if done.returncode != 0:
        raise Unanswerable("invalid-recording", done.stderr.strip().splitlines()[-1] if done.stderr else "")
    return json.loads(done.stdout)
