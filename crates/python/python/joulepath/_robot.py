"""Robots."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import Any, Union

from . import _native
from ._answers import table
from ._documents import encode
from .errors import InvalidRobotError


class Robot:
    """A robot: its measures, motors, surfaces, limits and how well each is known, checked.

    The fields of the robot file are attributes, in SI units as their names say.

    >>> import joulepath
    >>> husky = joulepath.Robot.builtin("husky-a200")
    >>> husky.mass_kg, husky.default_surface
    (90.0, 'marble')
    >>> husky.replace(mass_kg=110.0).mass_kg
    110.0
    """

    def __init__(self, document: dict[str, Any] | str | _native.Robot) -> None:
        if isinstance(document, dict):
            document = encode(document)
        self._native = document if isinstance(document, _native.Robot) else _native.Robot.from_json(document)
        self._parsed: dict[str, Any] | None = None

    @staticmethod
    def builtin(name: str = "husky-a200") -> Robot:
        """A built-in robot by its name.

        Raises ``UnknownRobotError``, which lists the names.

        >>> import joulepath
        >>> joulepath.Robot.builtin("jackal").name
        'jackal'
        """
        return Robot(_native.Robot.builtin(name))

    @staticmethod
    def names() -> list[str]:
        """Names of the built-in robots.

        >>> import joulepath
        >>> "husky-a200" in joulepath.Robot.names()
        True
        """
        return _native.Robot.names()

    @staticmethod
    def open(path: str | os.PathLike[str]) -> Robot:
        """A robot from a robot file (JSON).

        Raises ``InvalidRobotError`` with the field at fault, ``OSError`` where the file cannot be read.

        >>> import joulepath, pathlib, tempfile
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "mule.json"
        >>> joulepath.Robot.builtin("jackal").replace(name="mule").save(path)
        >>> joulepath.Robot.open(path).name
        'mule'
        """
        return Robot(FilePath(path).read_text(encoding="utf-8"))

    @staticmethod
    def from_data_sheet(name: str, *, surfaces: Sequence[str] = ("grass",), **figures: Any) -> Robot:
        """A robot from what its data sheet tells; what it does not tell is borrowed, and the robot file says so.

        ``figures``: ``mass_kg``, ``wheelbase_m``, ``track_m``, ``wheel_radius_m`` and ``max_speed_mps``, and what is known of motors
        (``rated_power_w`` of all, or ``motor_torque_constant_nm_per_a``, ``motor_resistance_ohm`` and ``gear_ratio``), ``battery_wh``,
        ``battery_v`` and others, by the names of ``joulepath robot new``. ``surfaces``: grounds of known friction, the first the default.

        Raises ``InvalidRequestError`` or ``InvalidRobotError`` with the figure at fault.

        >>> import joulepath
        >>> mule = joulepath.Robot.from_data_sheet("mule", mass_kg=17, wheelbase_m=0.262, track_m=0.43, wheel_radius_m=0.098,
        ...     max_speed_mps=2, rated_power_w=250)
        >>> mule.provenance["mass_kg"], mule.default_surface
        ('data-sheet', 'grass')
        """
        return Robot(_native.robot_of_data_sheet(encode({"name": name, "surfaces": list(surfaces), **figures})))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the robot file."""
        FilePath(path).write_text(json.dumps(self.to_dict(), indent=2) + "\n", encoding="utf-8")

    def replace(self, **fields: Any) -> Robot:
        """The same robot with other values of some fields, checked anew.

        A dict replaces the members that it names, and only those: ``replace(battery={"capacity_wh": 600})``.

        Raises ``InvalidRobotError`` with the field at fault.

        >>> import joulepath
        >>> husky = joulepath.Robot.builtin("husky-a200")
        >>> husky.replace(limits={"max_pitch_rad": 0.3}).limits["max_pitch_rad"]
        0.3
        >>> husky.replace(mass_kg=-1.0)
        Traceback (most recent call last):
            ...
        joulepath.errors.InvalidRobotError: ...
        """
        unknown = [name for name in fields if not name.isidentifier()]
        if unknown:
            raise InvalidRobotError(f"{unknown[0]!r} is no field of a robot", pointer=f"/{unknown[0]}")
        return Robot(_merged(self.to_dict(), fields))

    def to_dict(self) -> dict[str, Any]:
        """The robot's document, every default filled in."""
        return json.loads(self._native.to_json())

    def to_json(self) -> str:
        """The same as text."""
        return self._native.to_json()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if self._parsed is None:
            self._parsed = self.to_dict()
        try:
            return self._parsed[name]
        except KeyError:
            raise AttributeError(f"the robot has no {name!r}; there are {', '.join(self._parsed)}") from None

    def __reduce__(self) -> tuple[Any, ...]:
        return Robot, (self.to_json(),)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, mass_kg={self.mass_kg}, surfaces={sorted(self.surfaces)})"

    def _repr_html_(self) -> str:
        return table([(name, value) for name, value in self.to_dict().items() if not isinstance(value, (list, dict))])


#: What is taken for a robot: one, the name of a built-in one, or its document.
RobotLike = Union[Robot, str, dict[str, Any]]


def robot_of(robot: RobotLike) -> Robot:
    """The robot that is meant: by itself, by the name of a built-in one or of a robot file, or by its document."""
    if isinstance(robot, Robot):
        return robot
    if isinstance(robot, dict):
        return Robot(robot)
    name = os.fspath(robot)
    return Robot.open(name) if name.endswith(".json") or os.sep in name else Robot.builtin(name)


def _merged(document: dict[str, Any], fields: dict[str, Any]) -> dict[str, Any]:
    merged = dict(document)
    for name, value in fields.items():
        old = merged.get(name)
        merged[name] = _merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged
