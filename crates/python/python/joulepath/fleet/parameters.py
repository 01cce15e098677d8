"""What runs over a fleet tell of its units: series of fitted parameters, and of power against the robot file."""

from __future__ import annotations

import datetime
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .random_effects import Series

SIGMAS_OF_95 = 3.92
"""Width of a 95 % interval of a normal variable in standard deviations."""
LOGARITHM_FROM_SIGMAS = 3.0
"""A parameter whose every value exceeds so many standard errors is looked at as its logarithm: units differ by shares, not by amounts."""
POWER_RATIO = "recorded_to_predicted_power"
"""Mean recorded power over the power that the robot file predicts, of diagnoses."""


@dataclass(frozen=True)
class Reading:
    """One value of one parameter of one drive."""

    parameter: str
    value: float
    sigma: float
    """Its standard error."""
    unit: str
    """Its physical unit, `1` for none."""


@dataclass(frozen=True)
class Parameter:
    """One parameter over the fleet."""

    name: str
    unit: str
    """Its physical unit, `1` for none."""
    relative: bool
    """Whether its series are logarithms."""
    fleet: list[Series]
    paths: dict[str, list[str]]
    """For each robot, the recordings behind its values."""
    dates: dict[str, list[str | None]]
    """For each robot, the days of its values."""

    def in_units(self, value: float) -> float:
        """A value of the series as the parameter itself."""
        return float(np.exp(value)) if self.relative else float(value)

    def change(self, size: float) -> float:
        """A difference of the series: a share where it is of logarithms, else in the parameter's unit."""
        return float(np.expm1(size)) if self.relative else float(size)


def readings_of(kind: str, result: dict[str, Any]) -> list[Reading]:
    """Returns what the result of one recording tells. Parameters that it does not determine are left out."""
    if kind == "calibrate":
        return [
            Reading(one["name"], one["value"], sigma, one["unit"])
            for one in result["parameters"]
            if one["determined"] and one["interval_95"] is not None
            for sigma in [(one["interval_95"][1] - one["interval_95"][0]) / SIGMAS_OF_95]
            if sigma > 0.0
        ]
    file = result.get("file")
    used_s = result["coverage"]["total"]["used_s"] if "total" in result.get("coverage", {}) else None
    if not file or not file["mean_power_w"] - file["bias_w"] > 0.0:
        return []
    predicted_w = file["mean_power_w"] - file["bias_w"]
    # Of an average over seconds only noise is known here; what differs from drive to drive is for the fleet to tell.
    sigma = file["noise_w"] / predicted_w / max(used_s or 1.0, 1.0) ** 0.5
    return [Reading(POWER_RATIO, file["mean_power_w"] / predicted_w, sigma, "1")] if sigma > 0.0 else []


def parameters_of(results: Iterable[dict[str, Any]]) -> list[Parameter]:
    """Returns every parameter with a series for each unit, drives in the order of their dates.

    `results` are outcomes of runs with their `kind` and `result`. A recording counts once for each parameter, whichever run read it last.
    """
    latest: dict[tuple[str, str], tuple[dict[str, Any], Reading]] = {}
    for outcome in results:
        for reading in readings_of(outcome["kind"], outcome["result"]):
            latest[reading.parameter, outcome["recording_id"]] = (outcome, reading)
    by_parameter: dict[str, dict[str, list[tuple[dict[str, Any], Reading]]]] = {}
    for (name, _), found in latest.items():
        by_parameter.setdefault(name, {}).setdefault(found[0]["unit"], []).append(found)
    first = min((_week(outcome["date"]) for outcome, _ in latest.values() if outcome["date"]), default=0.0)
    return [_parameter(name, units, first) for name, units in by_parameter.items()]


def _parameter(name: str, units: dict[str, list[tuple[dict[str, Any], Reading]]], first_week: float) -> Parameter:
    values = [reading for found in units.values() for _, reading in found]
    relative = all(reading.value > LOGARITHM_FROM_SIGMAS * reading.sigma for reading in values)
    fleet, paths, dates = [], {}, {}
    for unit in sorted(units):
        found = sorted(units[unit], key=lambda one: (one[0]["date"] or "", one[0]["path"]))
        value = np.array([reading.value for _, reading in found])
        sigma = np.array([reading.sigma for _, reading in found])
        week = np.array([_week(outcome["date"]) - first_week if outcome["date"] else np.nan for outcome, _ in found])
        fleet.append(Series(unit, np.log(value) if relative else value, sigma / value if relative else sigma, week))
        paths[unit] = [outcome["path"] for outcome, _ in found]
        dates[unit] = [outcome["date"] for outcome, _ in found]
    return Parameter(name, values[0].unit, relative, fleet, paths, dates)


def _week(date: str) -> float:
    return datetime.date.fromisoformat(date).toordinal() / 7.0
