"""The report of a fleet as one HTML page, without scripts or outside resources."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._optional import needed
from .parameters import Parameter
from .random_effects import Series

WIDTH, HEIGHT, MARGIN = 640.0, 220.0, 56.0
"""Size of a chart and of the room for the values at its left, in CSS pixels."""
FOOT = 22.0
"""Room for the days below a chart, in CSS pixels."""
DAYS_OF_WEEK = 7.0


@dataclass(frozen=True)
class Line:
    """The series of a unit on a chart."""

    unit: str
    points: list[tuple[float, float]]

    @property
    def path(self) -> str:
        """The points as SVG has them."""
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in self.points)


@dataclass(frozen=True)
class Chart:
    """A parameter of one unit over the weeks, before those of all others."""

    title: str
    own: Line
    others: list[Line]
    ticks: list[tuple[float, str]]
    """Values on the upright axis: their height and what they are called."""
    days: list[tuple[float, str]]
    """Days on the level axis."""
    since: float | None
    """Where a step is, on the level axis."""


def page(document: dict[str, Any], parameters: list[Parameter]) -> str:
    """Returns the page of a report's document."""
    jinja2 = needed("jinja2")
    loader = jinja2.PackageLoader("joulepath.fleet", "templates")
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined)
    environment.filters.update(figure=_figure, percent=_percent, probability=_probability)
    by_name = {one.name: one for one in parameters}
    charts = {one["unit"]: _chart(one, by_name) for one in document["named"]}
    template = environment.get_template("report.html.j2")
    return template.render(report=document, charts=charts, width=WIDTH, height=HEIGHT, margin=MARGIN, foot=FOOT)


def _chart(named: dict[str, Any], parameters: dict[str, Parameter]) -> Chart | None:
    """The parameter of a unit that departs most clearly, where its drives have dates."""
    departure = named["departures"][0]
    parameter = parameters[departure["parameter"]]
    series = [one for one in parameter.fleet if one.dated]
    own = next((one for one in series if one.unit == named["unit"]), None)
    if own is None:
        return None
    weeks = np.concatenate([one.week for one in series])
    values = np.concatenate([_values(one, parameter) for one in series])
    across = _scale(float(weeks.min()), float(weeks.max()), MARGIN, WIDTH - 12.0)
    up = _scale(float(values.min()), float(values.max()), HEIGHT - FOOT, 12.0)

    def line(one: Series) -> Line:
        points = zip(one.week, _values(one, parameter), strict=True)
        return Line(one.unit, [(across(float(week)), up(float(value))) for week, value in points])

    ticks = [(up(value), _figure(value)) for value in np.linspace(values.min(), values.max(), 4)]
    first = _first_day(parameter, own)
    days = [(across(week), (first + datetime.timedelta(days=DAYS_OF_WEEK * week)).isoformat()) for week in (weeks.min(), weeks.max())]
    step = departure["since"] and parameter.dates[own.unit].index(departure["since"])
    since = across(float(own.week[step - 1] + own.week[step]) / 2.0) if step else None
    unit = "" if parameter.unit == "1" else f" [{parameter.unit}]"
    others = [line(one) for one in series if one.unit != own.unit]
    return Chart(f"{parameter.name}{unit}", line(own), others, ticks, days, since)


def _first_day(parameter: Parameter, own: Series) -> datetime.date:
    """The day from which weeks are counted."""
    day = datetime.date.fromisoformat(parameter.dates[own.unit][0] or "")
    return day - datetime.timedelta(days=round(DAYS_OF_WEEK * float(own.week[0])))


def _values(one: Series, parameter: Parameter) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.exp(one.value) if parameter.relative else one.value


def _scale(low: float, high: float, start: float, end: float) -> Any:
    """Maps values to places on an axis."""
    width = high - low
    return lambda value: (start + end) / 2.0 if width <= 0.0 else start + (end - start) * (value - low) / width


def _figure(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.3g} %"


def _probability(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.2g}" if value >= 1e-4 else "below 0.0001"
