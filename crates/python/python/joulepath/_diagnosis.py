"""Drives against a robot: predicted, fitted, diagnosed and simulated."""

from __future__ import annotations

import json
import os
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Union

from . import _native
from ._answers import Answer, Columns, page
from ._documents import encode
from ._optional import needed
from ._progress import Progress, told
from ._recording import ColumnsLike, Recording, RecordingLike, recording_of
from ._robot import Robot, RobotLike, robot_of

if TYPE_CHECKING:
    import numpy.typing

#: A document, or the path of its file.
DocumentLike = Union[dict[str, Any], str, "os.PathLike[str]"]


class Prediction(Answer):
    """Predicted against recorded power: what ``joulepath predict --json`` prints.

    ``runs`` and ``total`` hold ``rows``, ``bias_w``, ``rmse_w``, ``r2``, ``recorded_j`` and ``predicted_j``; ``columns`` the power itself.
    """

    runs: list[dict[str, Any]]
    total: dict[str, Any]

    def __init__(self, native: _native.Predicted) -> None:
        super().__init__(native.document())
        self._native = native

    @property
    def columns(self) -> Columns:
        """By row that was compared: ``run`` (its index), ``t_s``, ``predicted_w`` and ``recorded_w``, NaN in gaps. Of shape ``(rows,)``."""
        return Columns(self._native.columns())

    def html(self) -> str:
        """The report as one HTML page."""
        return self._native.html()

    def plot(self, ax: Any = None) -> Any:
        """Draws recorded and predicted power over time by ``matplotlib`` and returns the axes."""
        axes = needed("matplotlib.pyplot").gca() if ax is None else ax
        columns = self.columns
        axes.plot(columns["t_s"], columns["recorded_w"], ".", markersize=2, color="gray", label="recorded")
        axes.plot(columns["t_s"], columns["predicted_w"], linewidth=1, color="tab:red", label="predicted")
        axes.set(xlabel="t [s]", ylabel="power [W]")
        axes.legend()
        return axes

    def _scalars(self) -> list[tuple[str, Any]]:
        return list(self.total.items())

    def _repr_html_(self) -> str:
        return page(self.html())


class Calibration(Answer):
    """A robot fitted to its drives: the document of ``POST /v1/calibrate``'s job."""

    parameters: list[dict[str, Any]]

    @property
    def robot(self) -> Robot:
        """The fitted robot, which says how well each of its constants is known."""
        return Robot(self._document["robot"])

    def _scalars(self) -> list[tuple[str, Any]]:
        return [(one["name"], one["value"]) for one in self.parameters]


class Diagnosis(Answer):
    """Where drives differ from the model, and which physics was left out: the document of ``POST /v1/diagnose``'s job.

    ``verdict``, ``sentence``, ``findings``, ``explanations``, ``baseline`` and ``corrected`` are those of the report.
    """

    verdict: str
    sentence: str
    findings: list[dict[str, Any]]

    def __init__(self, native: _native.Diagnosed) -> None:
        super().__init__(native.document())
        self._native = native

    @property
    def corrected_robot(self) -> Robot:
        """The robot with what was found of it put right."""
        return Robot(self._native.corrected_robot())

    @property
    def trace(self) -> dict[str, numpy.typing.NDArray[Any]]:
        """Power over time by name, all rows: ``t_s`` and what was recorded, predicted and corrected [W]."""
        import numpy

        return {name: numpy.array(values) for name, values in json.loads(self._native.trace()).items()}

    def html(self) -> str:
        """The report as one HTML page."""
        return self._native.html()

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes ``report.json``, ``report.html`` and ``corrected-robot.json`` into a folder, which is made if need be."""
        out = FilePath(folder)
        out.mkdir(parents=True, exist_ok=True)
        (out / "report.json").write_text(json.dumps(self.to_dict(), indent=2) + "\n", encoding="utf-8")
        (out / "report.html").write_text(self.html(), encoding="utf-8")
        self.corrected_robot.save(out / "corrected-robot.json")

    def __repr__(self) -> str:
        return f"Diagnosis({self.verdict}: {self.sentence})"

    def _repr_html_(self) -> str:
        return page(self.html())


def predict(recordings: RecordingLike, robot: RobotLike = "husky-a200", *, columns: ColumnsLike = None) -> Prediction:
    """Predicts the power of recorded drives and compares it with what was recorded.

    ``recordings``: a ``Recording``, paths of logs, a table of pandas, pyarrow or polars, or arrays by name. ``columns``: a map of their
    columns or topics.

    Raises ``InsufficientRecordingError``, ``UnknownSurfaceError`` and those of ``Recording.open``.

    >>> import joulepath, numpy
    >>> t_s = numpy.arange(0.0, 60.0, 0.1)
    >>> drive = {"t_s": t_s, "v_left_mps": 0.5 + 0 * t_s, "v_right_mps": 0.5 + 0 * t_s, "power_w": 80 + 0 * t_s}
    >>> found = joulepath.predict(drive, "husky-a200")
    >>> found.total["rows"], found.columns["predicted_w"].shape
    (600, (600,))
    """
    robot = robot_of(robot)
    return Prediction(_native.predict(robot._native, recording_of(recordings, robot, columns)._native))


def calibrate(
    recordings: RecordingLike,
    robot: RobotLike = "husky-a200",
    *,
    method: str = "fit",
    reference_surface: str | None = None,
    despite: list[str] | None = None,
    columns: ColumnsLike = None,
    progress: Progress = None,
) -> Calibration:
    """Fits a robot to its recordings.

    ``method``: ``"fit"`` or ``"dogru-marques"``. ``despite``: names of doubts about the recordings that are overruled. ``progress``: a
    function of the step and the share that is done, true to show it, false for nothing.

    Raises ``InsufficientRecordingError``, ``UnknownSurfaceError`` and those of ``Recording.open``.
    """
    robot = robot_of(robot)
    options = json.dumps([method, reference_surface, despite or []])
    recording = recording_of(recordings, robot, columns)
    return Calibration(_native.calibrate(robot._native, recording._native, options, told(progress)))


def diagnose(
    recordings: RecordingLike,
    robot: RobotLike = "husky-a200",
    *,
    healthy: RecordingLike | None = None,
    simulated: RecordingLike | None = None,
    ruled_out: list[str] | None = None,
    columns: ColumnsLike = None,
    progress: Progress = None,
) -> Diagnosis:
    """Finds where drives differ from a robot's model, which physics was left out, and how large it is.

    ``healthy``: drives of the same robot known to be in order (``reference`` of the HTTP API). ``simulated``: another simulator's log of the
    same drives, in the place of the robot file. ``ruled_out``: mechanisms that are known not to act.

    Raises ``InsufficientRecordingError``, ``UnknownSurfaceError``, ``InvalidRequestError`` and those of ``Recording.open``.
    """
    robot = robot_of(robot)
    suspect = recording_of(recordings, robot, columns)
    others = [None if one is None else recording_of(one, robot, columns)._native for one in (healthy, simulated)]
    found = _native.diagnose(robot._native, suspect._native, others[0], others[1], list(ruled_out or []), told(progress))
    return Diagnosis(found)


class Simulation:
    """A drive through a world of its own: its recording, and what is true of it where that was asked for."""

    def __init__(self, recording: Recording, csv: bytes, key: dict[str, Any] | None) -> None:
        #: What the robot's sensors recorded.
        self.recording = recording
        #: What the world conceals, which a diagnosis may be scored by; ``None`` unless it was asked for.
        self.key = key
        self._csv = csv

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the recording (CSV), as ``joulepath simulate --out`` does."""
        FilePath(path).write_bytes(self._csv)

    def __repr__(self) -> str:
        return f"Simulation({self.recording!r})"


def simulate(world: DocumentLike, drive: DocumentLike, robot: RobotLike = "husky-a200", *, key: bool = False) -> Simulation:
    """Records a drive through a world of its own, which may conceal effects.

    ``world`` and ``drive``: the documents of ``joulepath simulate``, or paths of their files. ``key``: whether to tell what is true of it.

    Raises ``InvalidRequestError`` with the field at fault.

    >>> import joulepath
    >>> drive = {"kind": "rich", "duration_s": 60, "seed": 1}
    >>> joulepath.simulate({"terrain": "level", "seed": 1}, drive).recording.rows > 500
    True
    """
    folder = None if isinstance(world, dict) else os.fspath(FilePath(world).parent)
    native, csv, truth = _native.simulate(robot_of(robot)._native, _text(world), _text(drive), folder, key)
    return Simulation(Recording(native), csv, None if truth is None else json.loads(truth))


def _text(document: DocumentLike) -> str:
    """A document as text, read where its path is given."""
    return encode(document) if isinstance(document, dict) else FilePath(document).read_text(encoding="utf-8")
