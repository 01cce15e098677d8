"""What can go wrong, as exceptions of one family.

Every exception holds what the HTTP API answers in its place: ``type``, ``title``, ``status``, ``detail`` and ``errors``, the fields at
fault by their JSON pointers. The detail says how to mend it.
"""

from __future__ import annotations

import json
from typing import Any


class Error(Exception):
    """Any failure of this package.

    >>> import joulepath
    >>> try:
    ...     joulepath.Robot.builtin("husky-a2000")
    ... except joulepath.Error as error:
    ...     print(error.type, error.pointer)
    unknown-robot /robot
    """

    #: The stable name of the failure, that of the HTTP API.
    type: str = "internal"
    #: Name for people.
    title: str = "Internal error"
    #: HTTP status that the service answers with.
    status: int = 500

    def __init__(self, detail: str, errors: list[dict[str, str]] | None = None, *, pointer: str | None = None) -> None:
        super().__init__(detail)
        self.detail = detail
        at = [] if pointer is None else [{"pointer": pointer, "detail": detail}]
        #: The fields at fault: JSON pointers into the arguments, each with what is wrong there.
        self.errors: list[dict[str, str]] = at if errors is None else errors

    @property
    def pointer(self) -> str | None:
        """The JSON pointer of the first field at fault; ``None`` where no field is."""
        return self.errors[0]["pointer"] if self.errors else None

    def to_dict(self) -> dict[str, Any]:
        """The problem document of the HTTP API (RFC 9457)."""
        head = {"type": self.type, "title": self.title, "status": self.status, "detail": self.detail}
        return {**head, "errors": self.errors} if self.errors else head

    def __reduce__(self) -> tuple[Any, ...]:
        # Workers of other processes hand failures on.
        return _unpickled, (type(self), self.detail, self.errors, self.type, self.title, self.status)


def _unpickled(kind: type[Error], detail: str, errors: list[dict[str, str]], name: str, title: str, status: int) -> Error:
    error = kind(detail, errors)
    error.type, error.title, error.status = name, title, status
    return error


class InvalidRequestError(Error, ValueError):
    """An argument cannot be: its pointer names it."""

    type, title, status = "invalid-request", "The request cannot be read", 400


class InvalidMapError(Error, ValueError):
    """A map cannot be used."""

    type, title, status = "invalid-map", "The map cannot be used", 400


class InvalidRobotError(Error, ValueError):
    """A robot cannot be used."""

    type, title, status = "invalid-robot", "The robot cannot be used", 400


class InvalidRecordingError(Error, ValueError):
    """A recording cannot be read."""

    type, title, status = "invalid-recording", "The recording cannot be read", 400


class UnknownRobotError(Error, LookupError):
    """There is no robot of that name."""

    type, title, status = "unknown-robot", "No such robot", 404


class UnknownSurfaceError(Error, LookupError):
    """A map or a recording names a surface that the robot lacks."""

    type, title, status = "unknown-surface", "A surface is unknown", 422


class InsufficientRecordingError(Error):
    """A recording is too short or too poor for what is asked of it."""

    type, title, status = "insufficient-recording", "The recording does not suffice", 422


class StartOutsideMapError(Error):
    """The start lies outside the map."""

    type, title, status = "start-outside-map", "The start lies outside the map", 422


class GoalOutsideMapError(Error):
    """The goal lies outside the map."""

    type, title, status = "goal-outside-map", "The goal lies outside the map", 422


class WaypointOutsideMapError(Error):
    """A pose of a list lies outside the map."""

    type, title, status = "waypoint-outside-map", "A pose lies outside the map", 422


class StartBlockedError(Error):
    """The robot cannot stand at the start."""

    type, title, status = "start-blocked", "The robot cannot stand at the start", 422


class GoalBlockedError(Error):
    """The robot cannot stand at the goal."""

    type, title, status = "goal-blocked", "The robot cannot stand at the goal", 422


class WaypointBlockedError(Error):
    """The robot cannot stand at a pose of a list."""

    type, title, status = "waypoint-blocked", "The robot cannot stand at a pose", 422


class NoPathError(Error):
    """No path leads to the goal."""

    type, title, status = "no-path", "There is no path", 422


class LimitsContradictError(Error):
    """No path keeps the limits."""

    type, title, status = "limits-contradict", "No path keeps the limits", 422


class DeadlineTooShortError(Error):
    """No order of the stops meets the deadline."""

    type, title, status = "deadline-too-short", "The deadline is too short", 422


class TimeoutError(Error):
    """Time ran out before there was an answer."""

    type, title, status = "timeout", "The search ran out of time", 504


class TooLargeError(Error):
    """More is asked for than can be held."""

    type, title, status = "too-large", "Too large", 413


class ShapeError(InvalidMapError):
    """An array has the wrong number of axes, or not as many values as another."""


class MaskedArrayError(InvalidRequestError):
    """A masked array, whose hidden values would be taken for numbers."""


class NotANumberError(InvalidRequestError):
    """NaN or an infinity where a number is needed."""


class UnitError(InvalidRequestError):
    """Numbers that cannot be in the unit that they are named by, as a pitch of 20 rad."""


class ColumnTypeError(InvalidRecordingError, TypeError):
    """A column that holds no numbers where numbers are needed, as one of Python objects."""


class RaggedColumnsError(InvalidRecordingError):
    """Columns of one table that differ in length."""


class TimeOrderError(InvalidRecordingError):
    """Time that does not increase within a run."""


class MissingCrsError(InvalidMapError):
    """The map has no coordinate reference system where one is needed."""


class NotInstalledError(Error, ImportError):
    """A package that is needed for this is not installed."""

    type, title, status = "not-installed", "A package is not installed", 500


def _classes(kind: type[Error]) -> dict[str, type[Error]]:
    found: dict[str, type[Error]] = {}
    for one in kind.__subclasses__():
        found.setdefault(one.type, one)
    return found


#: The class of each type of failure.
BY_TYPE: dict[str, type[Error]] = _classes(Error)


def from_problem(text: str, class_name: str | None = None) -> Error:
    """The exception of a problem document, as the native half raises it."""
    problem = json.loads(text)
    detail, errors = problem["detail"], problem.get("errors", [])
    kind = globals()[class_name] if class_name else BY_TYPE.get(problem["type"], Error)
    error = kind(detail, errors)
    error.type, error.title, error.status = problem["type"], problem["title"], problem["status"]
    return error
