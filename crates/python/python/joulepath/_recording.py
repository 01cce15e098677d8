"""Recordings of drives."""

from __future__ import annotations

import json
import os
import warnings as python_warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native
from ._answers import table
from ._documents import encode
from ._progress import Progress, told
from ._robot import RobotLike, robot_of
from ._tables import tuples_of
from .errors import InvalidRequestError

if TYPE_CHECKING:
    import numpy.typing

PathLike = Union[str, "os.PathLike[str]"]
ColumnsLike = Union[str, Mapping[str, Any], None]


class Recording:
    """Drives of a robot as channels by row, checked: times increase within a run, what is missing is NaN.

    Channels are those of the recording format, in SI units: ``t_s``, ``v_left_mps``, ``v_right_mps``, power as ``power_w``, or
    ``power_left_w`` and ``power_right_w``, or ``current_a`` and ``voltage_v``, or motor currents; ``pitch_rad`` and others if they are
    there. ``surface`` and ``run`` are text.

    >>> import joulepath, numpy
    >>> t_s = numpy.arange(0.0, 60.0, 0.1)
    >>> drive = {"t_s": t_s, "v_left_mps": 0.5 + 0 * t_s, "v_right_mps": 0.5 + 0 * t_s, "power_w": 80 + 0 * t_s}
    >>> recording = joulepath.Recording.from_columns(drive)
    >>> recording.rows, round(recording.duration_s, 1), recording["power_w"][:2].tolist()
    (600, 59.9, [80.0, 80.0])
    """

    def __init__(self, native: _native.Recording) -> None:
        self._native = native

    @staticmethod
    def open(
        path: PathLike | Sequence[PathLike],
        *,
        columns: ColumnsLike = None,
        robot: RobotLike = "husky-a200",
        surface: str | None = None,
        runs: Iterable[str] | None = None,
        progress: Progress = None,
    ) -> Recording:
        """Reads a log, or several whose runs follow one another: CSV, Parquet, MCAP, rosbag2, ROS 1 bags, ULog.

        ``columns``: a map of columns or topics as a dict, or the name of a built-in one; by default topics of a Husky, or of a PX4 rover in
        ``.ulg``. ``robot``: whose wheels topics of joint states turn. ``surface``: what ground is that the log does not name. ``runs``: those
        that are kept.

        Raises ``InvalidRecordingError`` or one of its kinds, with file, line or row, and mend.

        >>> import joulepath
        >>> joulepath.Recording.open("no-such.csv")
        Traceback (most recent call last):
            ...
        joulepath.errors.InvalidRecordingError: no-such.csv: ...
        """
        paths = [path] if isinstance(path, (str, os.PathLike)) else list(path)
        if not paths:
            raise InvalidRequestError("there is no recording: give at least one path", pointer="/recordings")
        names = [os.fspath(one) for one in paths]
        native = _native.Recording.open(names, _columns(columns), robot_of(robot)._native, told(progress))
        recording = Recording(native)
        if runs is not None:
            recording = Recording(recording._native.of_runs(list(runs)))
        return recording._checked(surface)

    @staticmethod
    def from_columns(
        columns_by_name: Mapping[str, Any],
        *,
        name: str = "drive",
        columns: ColumnsLike = None,
        robot: RobotLike = "husky-a200",
        surface: str | None = None,
    ) -> Recording:
        """A recording from arrays by name, each one-dimensional and as long as the others; NaN is a gap.

        ``name`` becomes that of the run where there is no column ``run``. ``columns``, ``robot`` and ``surface`` are those of ``open``.

        Raises ``MaskedArrayError``, ``ColumnTypeError``, ``RaggedColumnsError``, ``TimeOrderError``, ``UnitError`` or
        ``InvalidRecordingError``.
        """
        held = tuples_of(columns_by_name)
        native = _native.Recording.from_columns(held, name, _columns(columns), robot_of(robot)._native)
        return Recording(native)._checked(surface)

    @staticmethod
    def from_pandas(
        frame: Any,
        *,
        name: str = "drive",
        columns: ColumnsLike = None,
        robot: RobotLike = "husky-a200",
        surface: str | None = None,
    ) -> Recording:
        """A recording from a ``pandas.DataFrame``, whose columns are those of a file; its index is left aside.

        Columns of doubles are not copied on their way. Arguments and errors are those of ``from_columns``.

        >>> import joulepath, pandas
        >>> frame = pandas.DataFrame({"t_s": [0.0, 0.1, 0.2], "v_left_mps": 0.5, "v_right_mps": 0.5, "power_w": [80.0, None, 82.0]})
        >>> joulepath.Recording.from_pandas(frame)["power_w"].tolist()
        [80.0, nan, 82.0]
        """
        held = {str(column): frame.iloc[:, place] for place, column in enumerate(frame.columns)}
        if len(held) < len(frame.columns):
            twice = frame.columns[frame.columns.duplicated()][0]
            raise InvalidRequestError(f"two columns are called {twice!r}: rename one", pointer=f"/{twice}")
        return Recording.from_columns(held, name=name, columns=columns, robot=robot, surface=surface)

    @staticmethod
    def from_arrow(
        table: Any,
        *,
        name: str = "drive",
        columns: ColumnsLike = None,
        robot: RobotLike = "husky-a200",
        surface: str | None = None,
    ) -> Recording:
        """A recording from a table of pyarrow, polars or any library that speaks Arrow's C stream interface.

        Columns of doubles in one piece without nulls are not copied on their way; nulls are gaps. Arguments and errors are those of
        ``from_columns``.

        >>> import joulepath, pyarrow
        >>> table = pyarrow.table({"t_s": [0.0, 0.1], "v_left_mps": [0.5, 0.5], "v_right_mps": [0.5, 0.5], "power_w": [80.0, None]})
        >>> joulepath.Recording.from_arrow(table)["power_w"].tolist()
        [80.0, nan]
        """
        if not hasattr(table, "__arrow_c_stream__"):
            kind = type(table).__name__
            detail = f"a {kind} does not speak Arrow: give a table of pyarrow or polars, or use from_pandas or from_columns"
            raise InvalidRequestError(detail, pointer="/table")
        native = _native.Recording.from_arrow(table, name, _columns(columns), robot_of(robot)._native)
        return Recording(native)._checked(surface)

    def _checked(self, surface: str | None) -> Recording:
        """The recording on ground that is named; what is suspicious of it becomes warnings."""
        for report in self.reports:
            for doubt in report["suspicions"]:
                run = f", run {doubt['run']}" if doubt.get("run") else ""
                python_warnings.warn(f"{doubt['channel']}{run}: {doubt['statement']}", RecordingWarning, stacklevel=3)
        return self if surface is None else Recording(self._native.on_surface(surface))

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self._native.rows()

    @property
    def duration_s(self) -> float:
        """Duration of all runs [s]."""
        return self._native.duration_s()

    @property
    def runs(self) -> dict[str, slice]:
        """The rows of each run, by its name."""
        return {name: slice(start, stop) for name, start, stop in self._native.runs()}

    @property
    def channels(self) -> list[str]:
        """Names of the channels that are there."""
        return self._native.names()[0]

    @property
    def aside(self) -> list[str]:
        """Names of columns that are no channel."""
        return self._native.names()[1]

    @property
    def reports(self) -> list[dict[str, Any]]:
        """What reading found: a report for each file."""
        return json.loads(self._native.reports())

    def __getitem__(self, name: str) -> numpy.typing.NDArray[Any]:
        """A column by row, NaN in gaps; texts for ``surface``."""
        if name == "surface":
            return self._surface()
        column = self._native.column(name)
        if column is None:
            there = ", ".join(["t_s", *self.channels, *self.aside])
            raise KeyError(f"the recording has no {name!r}; there are {there}")
        return column

    def _surface(self) -> numpy.typing.NDArray[Any]:
        import numpy

        found = self._native.surface()
        if found is None:
            raise KeyError("the recording names no surface")
        names, codes = found
        return numpy.array([*names, None], dtype=object)[codes]

    def to_pandas(self) -> Any:
        """The recording as a ``pandas.DataFrame``, with a column ``run``."""
        import numpy

        from ._optional import needed

        run = numpy.concatenate([numpy.full(rows.stop - rows.start, name) for name, rows in self.runs.items()])
        held = {name: self[name] for name in ["t_s", *self.channels, *self.aside]}
        if self._native.surface() is not None:
            held["surface"] = self._surface()
        return needed("pandas").DataFrame({"run": run, **held})

    def __len__(self) -> int:
        return self.rows

    def __repr__(self) -> str:
        return f"Recording({self.rows} rows, {self.duration_s:.1f} s, runs={list(self.runs)}, channels={self.channels})"

    def _repr_html_(self) -> str:
        head = [("rows", self.rows), ("duration_s", self.duration_s), ("runs", len(self.runs))]
        return table([*head, ("channels", ", ".join(self.channels))])


class RecordingWarning(UserWarning):
    """What is suspicious of a recording, in a sentence."""


#: What is taken for a recording: one, paths of logs, a table in memory, or arrays by name.
RecordingLike = Any


def recording_of(recordings: RecordingLike, robot: RobotLike, columns: ColumnsLike = None) -> Recording:
    """The recording that is meant, whatever holds it."""
    if isinstance(recordings, Recording):
        return recordings
    if isinstance(recordings, (str, os.PathLike)):
        return Recording.open(recordings, robot=robot, columns=columns)
    if hasattr(recordings, "iloc"):
        return Recording.from_pandas(recordings, robot=robot, columns=columns)
    if hasattr(recordings, "__arrow_c_stream__"):
        return Recording.from_arrow(recordings, robot=robot, columns=columns)
    if isinstance(recordings, Mapping):
        return Recording.from_columns(recordings, robot=robot, columns=columns)
    if isinstance(recordings, Sequence):
        return Recording.open(recordings, robot=robot, columns=columns)
    kind = type(recordings).__name__
    detail = f"a {kind} is no recording: give a Recording, paths, a table of pandas, pyarrow or polars, or arrays by name"
    raise InvalidRequestError(detail, pointer="/recordings")


def _columns(columns: ColumnsLike) -> str | None:
    """A map of columns, or the name of a built-in one, as JSON."""
    if columns is None:
        return None
    return json.dumps(columns) if isinstance(columns, str) else encode(dict(columns))
