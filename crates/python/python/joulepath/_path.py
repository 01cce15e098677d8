"""Planned paths."""

from __future__ import annotations

import html
import json
from typing import TYPE_CHECKING, Any

from . import _native
from ._answers import Answer, Columns, table
from ._optional import needed

if TYPE_CHECKING:
    from ._map import Map

#: Fields that the first look at a path shows.
SHOWN = ("energy_j", "energy_interval_j", "duration_s", "distance_m", "climb_m", "descent_m", "recovered_j", "refined_energy_j")

#: Width of the drawing of a path in notebooks [px].
DRAWN_PX = 320


class Path(Answer):
    """A path with its predicted energy: what ``POST /v1/plan`` answers.

    Totals are attributes (``energy_j``, ``energy_interval_j``, ``duration_s``, ``distance_m``, ...); ``poses`` are columns.

    >>> import joulepath, numpy
    >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
    >>> path = planner.plan((2.0, 10.0, 0.0), (20.0, 10.0))
    >>> path.energy_j > 0, round(path.poses["x_m"].max())
    (True, 20)
    """

    energy_j: float
    energy_interval_j: list[float]
    duration_s: float
    distance_m: float
    climb_m: float
    descent_m: float
    recovered_j: float
    search: dict[str, Any]
    warnings: list[dict[str, str]]

    def __init__(self, native: _native.Path, map: Map) -> None:
        super().__init__(native.totals())
        self._native, self._map = native, map
        self._columns: dict[bool, Columns | None] = {}

    @property
    def poses(self) -> Columns:
        """The path pose by pose: ``x_m``, ``y_m``, ``z_m``, ``heading_rad``, ``t_s``, ``distance_m``, ``energy_j``, ``power_w``,
        ``pitch_rad``, ``roll_rad`` and ``radius_m``, with ``lon_deg`` and ``lat_deg`` where the map has a CRS. All of shape ``(poses,)``."""
        return self._poses(False) or Columns({})

    @property
    def refined_poses(self) -> Columns | None:
        """The same of the path that is freed from the lattice; ``None`` where none was asked for."""
        return self._poses(True)

    def _poses(self, refined: bool) -> Columns | None:
        if refined not in self._columns:
            found = self._native.poses(refined)
            self._columns[refined] = None if found is None else Columns(found)
        return self._columns[refined]

    def _followed(self) -> Columns:
        """The refined poses where there are any, else those of the lattice: what is drawn."""
        refined = self.refined_poses
        return self.poses if refined is None else refined

    def to_dict(self) -> dict[str, Any]:
        """The document that the HTTP API answers with, poses included."""
        return json.loads(self._native.document())

    def to_geodataframe(self, *, crs: str | None = None) -> Any:
        """The poses as a ``geopandas.GeoDataFrame`` of points with their columns, in the map's system of coordinates.

        Raises ``MissingCrsError`` where the map has none and ``crs`` is not given.
        """
        geopandas = needed("geopandas")
        poses = self.poses
        points = geopandas.points_from_xy(poses["x_m"], poses["y_m"], poses["z_m"])
        columns = {name: column for name, column in poses.items() if name not in ("x_m", "y_m", "z_m")}
        return geopandas.GeoDataFrame(columns, geometry=points, crs=self._map.needed_crs(crs))

    def to_xarray(self) -> Any:
        """The poses as an ``xarray.Dataset`` along ``pose``, the totals as its attributes."""
        columns = {name: ("pose", column) for name, column in self.poses.items()}
        return needed("xarray").Dataset(columns, attrs=dict(self._scalars()))

    def plot(self, ax: Any = None, *, color: str = "black", label: str | None = None) -> Any:
        """Draws the path, refined where it was, over its map by ``matplotlib`` and returns the axes; ``ax`` to draw over what is there."""
        axes = self._map.plot() if ax is None else ax
        poses = self._followed()
        axes.plot(poses["x_m"], poses["y_m"], color=color, label=label)
        axes.plot(poses["x_m"][:1], poses["y_m"][:1], "o", color=color)
        return axes

    def __repr__(self) -> str:
        return f"Path({self.energy_j:.0f} J, {self.distance_m:.1f} m, {self.duration_s:.0f} s, {self.poses.rows} poses)"

    def _repr_html_(self) -> str:
        shown = [(name, self._document[name]) for name in SHOWN if self._document.get(name) is not None]
        warned = [("warning", warning["detail"]) for warning in self._document.get("warnings", [])]
        return f"<div style='display: flex; gap: 1em'>{self._drawing()}{table(shown + warned)}</div>"

    def _drawing(self) -> str:
        """The line of the path within the map's outline as SVG."""
        (west, south), (rows, columns), step_m = self._map.origin_m, self._map.shape, self._map.cell_size_m
        wide_m, high_m = columns * step_m, rows * step_m
        scale = DRAWN_PX / max(wide_m, high_m)
        poses = self._followed()
        points = " ".join(f"{scale * (x - west):.1f},{scale * (south + high_m - y):.1f}" for x, y in zip(poses["x_m"], poses["y_m"]))
        size = f"width='{scale * wide_m:.0f}' height='{scale * high_m:.0f}'"
        title = html.escape(repr(self))
        line = f"<polyline points='{points}' fill='none' stroke='#d1495b' stroke-width='2'/>"
        outline = "<rect width='100%' height='100%' fill='#8881' stroke='#8888'/>"
        return f"<svg {size} role='img' aria-label='{title}'>{outline}{line}</svg>"


class Comparison(Answer):
    """The energy-minimal, shortest and fastest paths: what ``POST /v1/compare`` answers."""

    #: What the energy-minimal path saves, as a share of the energy of the shortest.
    saving_fraction: float

    def __init__(self, energy: Path, distance: Path, time: Path, saving_fraction: float) -> None:
        super().__init__({"saving_fraction": saving_fraction})
        self.energy, self.distance, self.time = energy, distance, time

    def to_dict(self) -> dict[str, Any]:
        """The document that the HTTP API answers with."""
        paths = {name: getattr(self, name).to_dict() for name in ("energy", "distance", "time")}
        return {**paths, "saving_fraction": self.saving_fraction}

    def plot(self, ax: Any = None) -> Any:
        """Draws the three paths over their map and returns the axes."""
        axes = self.energy.plot(ax, color="tab:red", label="energy")
        self.distance.plot(axes, color="black", label="distance")
        self.time.plot(axes, color="tab:blue", label="time")
        axes.legend()
        return axes

    def __repr__(self) -> str:
        return f"Comparison(energy={self.energy!r}, distance={self.distance!r}, time={self.time!r}, saving_fraction={self.saving_fraction:.3f})"

    def _repr_html_(self) -> str:
        parts = (f"<h4>{name}</h4>{getattr(self, name)._repr_html_()}" for name in ("energy", "distance", "time"))
        return "".join(parts)


class Alternatives(Answer):
    """Paths that trade energy for time or length: what ``POST /v1/alternatives`` answers."""

    def __init__(self, paths: list[Path], document: str) -> None:
        super().__init__(document)
        self.alternatives = paths

    def to_dict(self) -> dict[str, Any]:
        """The document that the HTTP API answers with."""
        return {**self._document, "alternatives": [path.to_dict() for path in self.alternatives]}

    def plot(self, ax: Any = None) -> Any:
        """Draws energy over time of the alternatives and returns the axes."""
        axes = needed("matplotlib.pyplot").gca() if ax is None else ax
        axes.plot([path.duration_s for path in self.alternatives], [path.energy_j for path in self.alternatives], "o-")
        axes.set(xlabel="duration [s]", ylabel="energy [J]")
        return axes


class Matrix(Answer):
    """Energy, time and length between many poses: what ``POST /v1/matrix`` answers.

    ``energy_j``, ``duration_s`` and ``distance_m`` have shape ``(sources, targets)``, NaN where no path leads.
    """

    def _matrix(self, name: str) -> Any:
        import numpy

        return numpy.array(self._document[name], dtype=numpy.float64)

    @property
    def energy_j(self) -> Any:
        """Energy drawn from the battery [J]."""
        return self._matrix("energy_j")

    @property
    def duration_s(self) -> Any:
        """Time [s]."""
        return self._matrix("duration_s")

    @property
    def distance_m(self) -> Any:
        """Length along the ground [m]."""
        return self._matrix("distance_m")

    def to_xarray(self) -> Any:
        """The three matrices as an ``xarray.Dataset`` over ``source`` and ``target``."""
        names = ("energy_j", "duration_s", "distance_m")
        return needed("xarray").Dataset({name: (("source", "target"), self._matrix(name)) for name in names})

    def __repr__(self) -> str:
        sources, targets = self.energy_j.shape
        return f"Matrix({sources} sources, {targets} targets, {len(self._document['unreachable'])} unreachable)"


class Reachable(Answer):
    """The ground within energies of a place: what ``POST /v1/reachable`` answers, a GeoJSON feature collection."""

    def __init__(self, document: str, map: Map) -> None:
        super().__init__(document)
        self._map = map

    def to_geodataframe(self) -> Any:
        """The contours as a ``geopandas.GeoDataFrame`` in longitude and latitude of WGS 84.

        Raises ``MissingCrsError`` where the map has no CRS: GeoJSON is then in its metres, see ``features``.
        """
        self._map.needed_crs(None)
        return needed("geopandas").GeoDataFrame.from_features(self._document["features"], crs="EPSG:4326")

    def __repr__(self) -> str:
        areas = (f"{one['properties']['energy_j']:.0f} J: {one['properties']['area_m2']:.0f} m²" for one in self._document["features"])
        return f"Reachable({', '.join(areas)})"


class Range(Answer):
    """Whether the battery lasts: what ``POST /v1/range`` answers."""


class Mission(Answer):
    """Many stops on a charge: what ``POST /v1/mission`` answers."""
