"""What is computed of one recording."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

import joulepath

from .question import Question


def version() -> str:
    """The version of joulepath that computes, on which its results depend."""
    return version_of("joulepath")


def answer(question: Question, recording: Path, healthy: Sequence[Path]) -> dict[str, Any]:
    """Returns the document that the HTTP API's job of the question has as its result.

    Raises a `joulepath.Error` where the recording or the robot is at fault.
    """
    robot = joulepath.Robot(question.robot) if isinstance(question.robot, dict) else joulepath.Robot.builtin(question.robot)
    columns = question.options.get("map")
    suspect = joulepath.Recording.open(recording, columns=columns, robot=robot, progress=False)
    if question.kind == "calibrate":
        return joulepath.calibrate(suspect, robot, progress=False).to_dict()
    known = joulepath.Recording.open(healthy, columns=columns, robot=robot, progress=False) if healthy else None
    ruled_out = question.options.get("ruled_out")
    return joulepath.diagnose(suspect, robot, healthy=known, ruled_out=ruled_out, progress=False).to_dict()
