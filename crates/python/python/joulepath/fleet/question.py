"""What is asked of every recording of a fleet."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import joulepath


@dataclass(frozen=True)
class Question:
    """A question to each recording, in the words of the HTTP API."""

    kind: str
    """`diagnose` or `calibrate`."""
    robot: str | dict[str, Any]
    """Name of a built-in robot, or a robot's file as a document."""
    options: dict[str, Any] = field(default_factory=dict)
    """Further fields of the request, such as `map` (of log columns) and `ruled_out`."""

    def request(self, recordings: list[str], healthy: list[str]) -> dict[str, Any]:
        """The request as the HTTP API would have it."""
        request = {**self.options, "robot": self.robot, "recordings": recordings}
        if self.kind == "diagnose":
            request["reference"] = healthy
        return request


def robot_document(robot: joulepath.Robot | str | dict[str, Any]) -> str | dict[str, Any]:
    """Returns what tasks on other machines are told of a robot, once it is checked: the name of a built-in one, or a document.

    Raises a `joulepath.Error` where it cannot be used.
    """
    if isinstance(robot, str) and robot in joulepath.Robot.names():
        return robot
    if isinstance(robot, joulepath.Robot):
        return robot.to_dict()
    if isinstance(robot, dict):
        return joulepath.Robot(robot).to_dict()
    try:
        return joulepath.Robot.open(robot).to_dict()
    except OSError as error:
        names = ", ".join(joulepath.Robot.names())
        raise joulepath.errors.InvalidRobotError(
            f"{robot} is neither a built-in robot ({names}) nor a robot file that can be read: {error.strerror}", pointer="/robot"
        ) from error
