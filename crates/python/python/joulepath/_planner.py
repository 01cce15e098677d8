"""Questions over a map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

from . import _native
from ._documents import encode, pose, poses
from ._map import Map
from ._path import Alternatives, Comparison, Matrix, Mission, Path, Range, Reachable
from ._robot import RobotLike, robot_of

#: A place: ``(x_m, y_m)``, ``(x_m, y_m, heading_rad)``, or a dict of the API's ``x_m``, ``y_m`` or ``lon_deg``, ``lat_deg`` and
#: ``heading_rad``.
Place = Union[Sequence[float], dict[str, Any]]


class Planner:
    """A robot on a map, with all that was worked out for them: later questions are answered sooner.

    Arguments are those of the HTTP bodies, and what is left out takes the API's default. Lengths are metres in the map's frame,
    headings radians counter-clockwise from east. Ctrl-C ends a question within 0.1 s; other threads go on meanwhile.

    >>> import joulepath, numpy
    >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5), "husky-a200")
    >>> planner
    Planner(Map(40 x 60 cells of 0.5 m, crs=None), 'husky-a200')
    """

    def __init__(self, map: Map, robot: RobotLike = "husky-a200") -> None:
        self.map, self.robot = map, robot_of(robot)
        self._native = _native.Planner(map._native)
        self._head = '{"robot": ' + self.robot.to_json()

    def _request(self, body: dict[str, Any]) -> str:
        """The body of a request, with the robot as it stands in one."""
        rest = encode(body)[1:]
        return self._head + (rest if rest == "}" else ", " + rest)

    def _plan_body(self, start: Place, goal: Place | None, goals: Sequence[Place] | None, options: dict[str, Any]) -> str:
        goal = None if goal is None else pose(goal, "goal")
        return self._request({"start": pose(start, "start"), "goal": goal, "goals": poses(goals, "goals"), **options})

    def plan(self, start: Place, goal: Place | None = None, *, goals: Sequence[Place] | None = None, **options: Any) -> Path:
        """The path of least energy, or of least ``objective``.

        ``options``: those of ``POST /v1/plan``, as ``objective`` (``"energy"``, ``"distance"``, ``"time"``), ``speed_mps``, ``bound``,
        ``timeout_s``, ``refine``, ``reverse``, ``max_time_s``, ``max_energy_j``, ``max_slope_rad``, ``areas``, ``prices``, ``forbid``.

        Raises ``NoPathError``, ``StartOutsideMapError``, ``GoalBlockedError``, ``TimeoutError``, ``InvalidRequestError`` and others of
        ``joulepath.errors``.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> round(planner.plan((2, 10, 0), (20, 10), objective="distance", speed_mps=0.4).distance_m, 1)
        18.0
        >>> planner.plan((2, 10, 0), (200, 10))
        Traceback (most recent call last):
            ...
        joulepath.errors.GoalOutsideMapError: ...
        """
        return Path(self._native.plan(self._plan_body(start, goal, goals, options)), self.map)

    def compare(self, start: Place, goal: Place | None = None, *, goals: Sequence[Place] | None = None, **options: Any) -> Comparison:
        """The energy-minimal, shortest and fastest paths; ``options`` and errors are those of ``plan``.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> found = planner.compare((2, 10, 0), (20, 10))
        >>> found.energy.energy_j <= found.distance.energy_j, found.saving_fraction >= 0
        (True, True)
        """
        energy, distance, time, saving = self._native.compare(self._plan_body(start, goal, goals, options))
        return Comparison(Path(energy, self.map), Path(distance, self.map), Path(time, self.map), saving)

    def alternatives(self, start: Place, goal: Place, **options: Any) -> Alternatives:
        """Paths that trade energy for time, or ``against="distance"`` for length.

        ``options``: those of ``POST /v1/alternatives``, as ``count`` and ``epsilon``.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> len(planner.alternatives((2, 10, 0), (20, 10), count=3).alternatives) >= 1
        True
        """
        body = {"start": pose(start, "start"), "goal": pose(goal, "goal"), **options}
        paths, document = self._native.alternatives(self._request(body))
        return Alternatives([Path(path, self.map) for path in paths], document)

    def matrix(self, sources: Sequence[Place], targets: Sequence[Place] | None = None, **options: Any) -> Matrix:
        """Energy, time and length from each source to each target; the sources are the targets by default.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> planner.matrix([(2, 10), (20, 10)]).energy_j.shape
        (2, 2)
        """
        body = {"sources": poses(sources, "sources"), "targets": poses(targets, "targets"), **options}
        return Matrix(self._native.ask("matrix", self._request(body)))

    def reachable(self, start: Place, **options: Any) -> Reachable:
        """The ground within ``energies_j`` or ``charges`` of a place; ``kind`` is ``"outward"``, ``"homeward"`` or ``"out-and-back"``.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> planner.reachable((15, 10), energies_j=[500.0]).features[0]["properties"]["area_m2"] > 0
        True
        """
        return Reachable(self._native.ask("reachable", self._request({"start": pose(start, "start"), **options})), self.map)

    def range(self, start: Place, goal: Place | None = None, **options: Any) -> Range:
        """How likely the battery lasts to a goal, or how far it carries.

        ``options``: those of ``POST /v1/range``, as ``charge``, ``samples`` and ``seed``; ``return_=True`` for the way back as well.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> planner.range((2, 10, 0), (20, 10), charge=0.8, samples=100).reachable
        True
        """
        goal = None if goal is None else pose(goal, "goal")
        return Range(self._native.ask("range", self._request({"start": pose(start, "start"), "goal": goal, **_back(options)})))

    def mission(self, start: Place, waypoints: Sequence[Place], **options: Any) -> Mission:
        """Many stops on a charge in the best order, or in the given ``order``.

        ``options``: those of ``POST /v1/mission``, as ``chargers``, ``deadline_s`` and ``return_``.

        >>> import joulepath, numpy
        >>> planner = joulepath.Planner(joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5))
        >>> planner.mission((2, 10, 0), [(20, 10), (10, 5)], samples=100).order
        [1, 0]
        """
        body = {"start": pose(start, "start"), "waypoints": poses(waypoints, "waypoints"), **_back(options)}
        return Mission(self._native.ask("mission", self._request(body)))

    def __repr__(self) -> str:
        return f"Planner({self.map!r}, {self.robot.name!r})"


def _back(options: dict[str, Any]) -> dict[str, Any]:
    """``return`` is a word of Python, so that ``return_`` stands for it."""
    return {"return" if name == "return_" else name: value for name, value in options.items()}
