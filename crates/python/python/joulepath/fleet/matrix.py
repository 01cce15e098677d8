"""Energy, time and length between thousands of places of a large map: a block of sources a task."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import joulepath

from .._progress import Progress
from . import compute
from .blocks import Work, answered
from .cluster import Ways
from .errors import FleetError
from .question import robot_document
from .storage import Storage, content_id, local_copy

BLOCK_SOURCES = 16
"""Sources of a block: the costs of the map are worked out once for them all."""
FIGURES = ("energy_j", "duration_s", "distance_m")
"""The figures of every pair."""

Place = tuple[float, ...]
"""x, y [m], and a heading [rad] where it matters."""


@dataclass(frozen=True)
class FleetMatrix:
    """Figures of every path, a row a source and a column a target; NaN where there is none."""

    energy_j: np.ndarray[Any, np.dtype[np.float64]]
    """Energy drawn from the battery [J]."""
    duration_s: np.ndarray[Any, np.dtype[np.float64]]
    """Time [s]."""
    distance_m: np.ndarray[Any, np.dtype[np.float64]]
    """Length along the ground [m]."""
    unreachable: list[dict[str, Any]]
    """`source`, `target` and `reason` of every pair without a path."""
    failed: list[dict[str, Any]]
    """`sources` and `reason` of every block of which nothing came."""

    def to_dict(self) -> dict[str, Any]:
        """The matrix as the HTTP API's document, with `failed` beside it."""
        figures = {name: [[None if np.isnan(x) else x for x in row] for row in getattr(self, name).tolist()] for name in FIGURES}
        return {**figures, "unreachable": self.unreachable, "failed": self.failed}

    def __str__(self) -> str:
        rows, columns = self.energy_j.shape
        lines = [f"{rows} sources, {columns} targets: {len(self.unreachable)} pairs without a path, {len(self.failed)} blocks failed"]
        return "\n".join(lines + [f"  failed: sources {one['sources'][0]} to {one['sources'][-1]}: {one['reason']}" for one in self.failed])


def matrix(
    map: str | os.PathLike[str],
    sources: Sequence[Place],
    targets: Sequence[Place] | None = None,
    *,
    robot: Any = "husky-a200",
    storage: str | os.PathLike[str] | Storage,
    block_sources: int = BLOCK_SOURCES,
    ways: Ways = Ways(),
    progress: Progress = None,
    **options: Any,
) -> FleetMatrix:
    """Works out the path between every source and every target, which are the sources unless given.

    `map` is a file or an `s3://` address, as tasks read it. Each block of sources is kept in the storage, so that a matrix whose driver died is
    taken up by asking again. `options` are those of `Planner.matrix`, as `speed_mps` and `reverse`. Raises a [`FleetError`] where the question itself is wrong.
    """
    storage = storage if isinstance(storage, Storage) else Storage(storage)
    targets = sources if targets is None else targets
    for field, places in (("sources", sources), ("targets", targets)):
        _check(field, places)
    if block_sources < 1:
        raise FleetError("invalid-request", f"block_sources must be 1 or more, not {block_sources}")
    try:
        with local_copy(os.fspath(map)) as file:
            map_id = content_id(file)
    except OSError as error:
        raise FleetError("invalid-map", f"cannot read the map {os.fspath(map)}: {error.strerror}") from error
    shared = {
        "map": os.fspath(map),
        "map_id": map_id,
        "robot": robot_document(robot),
        "targets": [list(place) for place in targets],
        "options": options,
        "version": compute.version(),
    }
    starts = range(0, len(sources), block_sources)
    blocks = [{**shared, "sources": [list(place) for place in sources[start : start + block_sources]]} for start in starts]
    answers = answered(Work("matrix", _block, storage.place), blocks, ways, progress)
    return _joined(answers, [(start, min(start + block_sources, len(sources))) for start in starts], (len(sources), len(targets)))


def _check(field: str, places: Sequence[Place]) -> None:
    if len(places) == 0:
        raise FleetError("invalid-request", f"{field}: there is no place")
    for i, place in enumerate(places):
        if len(place) not in (2, 3) or not np.all(np.isfinite(np.asarray(place, float))):
            raise FleetError("invalid-request", f"{field}[{i}]: a place is x, y in metres and, where it matters, a heading in radians, not {place!r}")


def _block(block: dict[str, Any]) -> dict[str, Any]:
    """The figures of a block, as the HTTP API has them."""
    planner = _planner(block["map"], block["map_id"], json.dumps(block["robot"]))
    return planner.matrix(block["sources"], block["targets"], **block["options"]).to_dict()


@functools.lru_cache(maxsize=1)
def _planner(map: str, map_id: str, robot: str) -> joulepath.Planner:
    """A planner, which a worker keeps from block to block: the costs of the map are worked out once."""
    with local_copy(map) as file:
        if content_id(file) != map_id:
            raise OSError(f"{map} is not the map that was asked about: it was changed, or this machine has another one")
        return joulepath.Planner(joulepath.Map.open(file), json.loads(robot))


def _joined(answers: list[dict[str, Any]], spans: list[tuple[int, int]], shape: tuple[int, int]) -> FleetMatrix:
    figures = {name: np.full(shape, np.nan) for name in FIGURES}
    unreachable, failed = [], []
    for (start, end), answer in zip(spans, answers, strict=True):
        if "failed" in answer:
            failed.append({"sources": list(range(start, end)), "reason": answer["failed"]})
            continue
        for name in FIGURES:
            figures[name][start:end] = np.array(answer["result"][name], dtype=float)
        unreachable += [{**one, "source": one["source"] + start} for one in answer["result"]["unreachable"]]
    return FleetMatrix(**figures, unreachable=unreachable, failed=failed)
