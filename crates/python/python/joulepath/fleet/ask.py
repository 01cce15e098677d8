"""The questions that a fleet is asked."""

from __future__ import annotations

import os
from typing import Any

from .._progress import Progress
from .cluster import Ways
from .departures import FALSE_ALARM_RATE
from .drives import Recordings, drives_of
from .question import Question, robot_document
from .report import FleetReport, report_of
from .run import Run, ask
from .storage import Storage


def diagnose(
    paths: Recordings,
    *,
    robot: Any = "husky-a200",
    healthy: Recordings = (),
    storage: str | os.PathLike[str] | Storage,
    ruled_out: list[str] | None = None,
    map: str | dict[str, Any] | None = None,
    ways: Ways = Ways(),
    progress: Progress = None,
) -> Run:
    """Diagnoses every recording of a fleet, one task each.

    `paths` are recordings, folders or patterns; the folder of a file names its unit and a date in its name the day, or see [`Drive`]. `healthy`
    are recordings known to be healthy: each drive is compared with those of its own unit. `robot` is the fleet's: a built-in one, a file, a
    document or a `joulepath.Robot`. `progress` is that of `joulepath.diagnose`. `map` names columns or topics. Paths are read where tasks run, so that every machine must see them.

    Returns what became of each recording. Raises a [`FleetError`] where the question itself is wrong; a recording that fails is counted and named.
    """
    options = {name: value for name, value in (("ruled_out", ruled_out), ("map", map)) if value is not None}
    question = Question("diagnose", robot_document(robot), options)
    return ask(
        question,
        drives_of(paths),
        _storage(storage),
        healthy=drives_of(healthy, "healthy") if healthy else (),
        ways=ways,
        progress=progress,
    )


def calibrate(
    paths: Recordings,
    *,
    robot: Any = "husky-a200",
    storage: str | os.PathLike[str] | Storage,
    map: str | dict[str, Any] | None = None,
    ways: Ways = Ways(),
    progress: Progress = None,
) -> Run:
    """Fits the robot to every recording of a fleet by itself, one task each, so that a report sees units differ and change.

    Arguments, result and errors are those of [`diagnose`].
    """
    question = Question("calibrate", robot_document(robot), {"map": map} if map is not None else {})
    return ask(question, drives_of(paths), _storage(storage), ways=ways, progress=progress)


def report(
    storage: str | os.PathLike[str] | Storage, *, runs: list[Run] | None = None, false_alarm_rate: float = FALSE_ALARM_RATE
) -> FleetReport:
    """Tells which robots differ from their fleet, by what, and since when.

    `runs` are those to look at; without them, all that the storage holds. `false_alarm_rate` is the chance that any robot is named of a fleet
    with none to name. Needs no Ray.
    """
    return report_of(_storage(storage), runs, false_alarm_rate)


def _storage(storage: str | os.PathLike[str] | Storage) -> Storage:
    return storage if isinstance(storage, Storage) else Storage(storage)
