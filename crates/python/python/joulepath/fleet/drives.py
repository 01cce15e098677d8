"""Drives of a fleet: which recording belongs to which unit, and of which day it is."""

from __future__ import annotations

import csv
import datetime
import glob
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Union

from .errors import FleetError

ENDINGS = (".csv", ".csv.gz", ".csv.zst", ".parquet", ".mcap", ".db3", ".bag", ".ulg")
"""Endings of the files that are taken from a folder. A file that is named itself may be called anything."""

DATE = re.compile(r"(?<!\d)(\d{4})[-_]?(\d{2})[-_]?(\d{2})(?!\d)")
"""A date in a file's name, as `2026-03-02`, `2026_03_02` (`ros2 bag record`) or `20260302`."""


@dataclass(frozen=True)
class Drive:
    """One recording of one unit."""

    path: str
    """File, folder of `ros2 bag record`, or `s3://` address, as the machine reads it on which the task runs."""
    unit: str
    """Name of the robot, by which a report calls it."""
    date: str | None = None
    """Day of the drive, as `2026-03-02`. Without one, the drive tells nothing of changes over weeks."""

    def __post_init__(self) -> None:
        if not self.path or not self.unit:
            raise FleetError("invalid-request", f"a drive needs a path and a unit, not {self.path!r} and {self.unit!r}")
        if self.date is not None:
            try:
                datetime.date.fromisoformat(self.date)
            except ValueError as error:
                raise FleetError("invalid-request", f"{self.path}: the date {self.date!r} is not a day as 2026-03-02") from error

    @classmethod
    def from_path(cls, path: str) -> Drive:
        """The drive of a path `.../UNIT/DATE...`: its folder is the unit, and a date in its name the day."""
        name = PurePosixPath(path.replace(os.sep, "/"))
        unit = name.parent.name
        if not unit:
            unit = Path(path).resolve().parent.name if "://" not in path else ""
        if not unit:
            raise FleetError("invalid-request", f"{path}: it lies in no folder that could name its unit; give a list with path, unit, date")
        return cls(path, unit, date_in(name.name))

    def to_dict(self) -> dict[str, Any]:
        """The drive as a document."""
        return asdict(self)


def date_in(name: str) -> str | None:
    """Returns the first day that a name holds, as `2026-03-02`, or none."""
    for match in DATE.finditer(name):
        try:
            return datetime.date(*(int(part) for part in match.groups())).isoformat()
        except ValueError:
            continue
    return None


Recordings = Union[str, os.PathLike[str], Iterable[Union[str, os.PathLike[str], Drive]], Mapping[str, Iterable[str]]]
"""Recordings of a fleet: paths, folders and patterns (`logs/*/*.mcap`), [`Drive`]s, lists of paths by unit, or a `pandas.DataFrame` with the columns
`path`, `unit` and `date`."""


def drives_of(recordings: Recordings, field: str = "paths") -> list[Drive]:
    """Returns the drives that a caller means, in the order given, files of a folder in the order of their names.

    Raises a `FleetError` where a path stands there twice, or a pattern or folder holds no recording.
    """
    if isinstance(recordings, (str, os.PathLike)):
        recordings = [recordings]
    found: list[Drive] = []
    if isinstance(recordings, Mapping):
        for unit, paths in recordings.items():
            for path in [paths] if isinstance(paths, (str, os.PathLike)) else paths:
                found += [Drive(one, str(unit), date_in(PurePosixPath(one).name)) for one in _expanded(os.fspath(path), field)]
    elif (to_dict := getattr(recordings, "to_dict", None)) is not None:
        found += _of_rows(to_dict("records"), field)
    else:
        for one in recordings:
            found += [one] if isinstance(one, Drive) else [Drive.from_path(path) for path in _expanded(os.fspath(one), field)]
    seen: set[str] = set()
    for drive in found:
        if drive.path in seen:
            raise FleetError("invalid-request", f"{field}: {drive.path} is named twice; name every recording once")
        seen.add(drive.path)
    return found


def read_list(path: str | os.PathLike[str]) -> list[Drive]:
    """Reads a table of drives: CSV with the columns `path`, `unit` and, where known, `date`. Relative paths count from the table."""
    folder = Path(path).parent
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise FleetError("invalid-request", f"cannot read the list of drives {os.fspath(path)}: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise FleetError("invalid-request", f"{os.fspath(path)} is no table of drives: {error}") from error
    if not rows:
        raise FleetError("invalid-request", f"{os.fspath(path)} names no drive: it needs a header path,unit,date and a line for each")
    for row in rows:
        name = row.get("path") or ""
        if name and "://" not in name:
            row["path"] = str(folder / name)
    return _of_rows(rows, os.fspath(path))


def _of_rows(rows: list[dict[str, Any]], field: str) -> list[Drive]:
    found = []
    for i, row in enumerate(rows):
        unknown = sorted(str(name) for name in set(row) - {"path", "unit", "date"})
        if unknown:
            raise FleetError("invalid-request", f"{field}, row {i + 1}: unknown column `{unknown[0]}`; known: path, unit, date")
        if not row.get("path") or not row.get("unit"):
            raise FleetError("invalid-request", f"{field}, row {i + 1}: it needs a path and a unit")
        date = row.get("date") or None
        found.append(Drive(os.fspath(row["path"]), str(row["unit"]), str(date)[:10] if date is not None and date == date else None))
    return found


def _expanded(path: str, field: str) -> list[str]:
    """The recordings that a path stands for."""
    if "://" in path:
        from .storage import files_below

        return [path] if _is_recording(path) else _some(files_below(path, ENDINGS), path, field)
    if glob.has_magic(path):
        return _some(sorted(glob.glob(path)), path, field)
    if os.path.isdir(path) and not os.path.exists(os.path.join(path, "metadata.yaml")):
        return _some(sorted(_below(path)), path, field)
    return [path]


def _below(folder: str) -> Iterable[str]:
    for place, folders, files in os.walk(folder):
        if "metadata.yaml" in files:
            folders.clear()
            yield place
            continue
        folders[:] = [name for name in folders if not name.startswith(".")]
        yield from (os.path.join(place, name) for name in files if _is_recording(name))


def _is_recording(name: str) -> bool:
    return name.endswith(ENDINGS)


def _some(paths: list[str], path: str, field: str) -> list[str]:
    if not paths:
        raise FleetError("invalid-request", f"{field}: {path} holds no recording; recordings end in {', '.join(ENDINGS)}")
    return paths
