"""What is asked of every recording of a fleet."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .errors import FleetError


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


class Unanswerable(Exception):
    """A recording of which nothing can be found, now or later: a problem of the recording, not of the machines."""

    def __init__(self, type: str, detail: str, errors: list[dict[str, str]] | None = None) -> None:
        super().__init__(detail)
        self.type, self.detail, self.errors = type, detail, errors or []


def robot_document(robot: Any) -> str | dict[str, Any]:
    """Returns what tasks on other machines are told of a robot: the name of a built-in one, or the document of a file or object."""
    if hasattr(robot, "to_dict"):
        return robot.to_dict()
    if isinstance(robot, Mapping):
        return dict(robot)
    name = os.fspath(robot)
    if not name.endswith(".json") and not os.path.exists(name):
        return name
    import json

    try:
        document = json.loads(Path(name).read_text(encoding="utf-8"))
    except OSError as error:
        raise FleetError("invalid-robot", f"cannot read the robot {name}: {error.strerror}") from error
    except ValueError as error:
        raise FleetError("invalid-robot", f"the robot {name} is no JSON: {error}") from error
    if not isinstance(document, dict):
        raise FleetError("invalid-robot", f"the robot {name} must be a JSON object")
    return document
