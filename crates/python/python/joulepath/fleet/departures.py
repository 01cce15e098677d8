"""Units beyond their fleet: tests of level, step and drift with one bound on the chance of any false alarm.

Three questions are asked of every parameter of every unit, each with the spreads that the other units show:

* `level`: is the unit's mean one that the fleet has? t = (y_i - mu) / sqrt(tau^2 + v_i + v_mu), with n - 2 degrees of freedom;
* `step`: did it change from one drive to the next? The largest |t| over all places of a step, its p-value times their number;
* `drift`: does it change from week to week, beyond what the fleet shares?

The smallest p-value of a unit times the number of its tests, times the number of units, is its p-value (Bonferroni). The unit with the least is
set aside and all is fitted anew, up to a third of the fleet, so that ill units hide neither each other nor themselves, as in the generalised extreme
Studentised deviate procedure (Rosner, Technometrics 25, 1983, doi:10.1080/00401706.1983.10487848). Critical values of that are too small for
fleets of a dozen: healthy units that are set aside narrow the spread of the others. Here a unit that comes after j others which were not clear by themselves
pays for all sets of j that could have been set aside, and half of the false-alarm rate is kept for j = 0, a quarter for j = 1, and so on. So the
chance that any unit of a healthy fleet is named is at most the false-alarm rate, whatever its size. Each unit is named only if it also differs from
the fleet that is left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb

import numpy as np
from scipy import stats

from .random_effects import Between, Series, Within, fit_between, fit_within, unit_mean

FALSE_ALARM_RATE = 0.01
"""Chance that a report names any unit of a fleet that has none to name [-]: one false alarm in two years of weekly reports."""
LARGEST_SHARE_SET_ASIDE = 1.0 / 3.0
"""Most of a fleet that can be named: what more than a third of the units does is what the fleet does."""
MOST_MASKED = 10
"""Most units that can hide one another: the search for more ends when so many in a row were not clear."""
MOST_GROUPS = 20
"""Groups that the spreads of others are worked out without, one after the other, so that a large fleet takes as many fits as one of 20 units."""
FEWEST_UNITS = 4
"""Units from which on a fleet has a spread to compare with."""
FEWEST_DRIVES = 3
"""Drives of a unit from which on a change can be told from the scatter of drives."""
CREDIBLE_DEVIANCE = 3.84
"""Deviance within which places of a step are credible: 95 % of a chi-squared variable of one degree of freedom."""


@dataclass(frozen=True)
class Departure:
    """One way in which a unit differs from its fleet, or from what it was."""

    unit: str
    parameter: str
    kind: str
    """`level`, `step` or `drift`."""
    size: float
    """How far the unit lies from the fleet's mean; how much it changed; how much it drifts in a week. In the unit of the series."""
    sigma: float
    """Standard error of the size; for `level`, spread of the fleet included."""
    t: float
    p_value: float
    """Bound on the chance of one as large among all tests of all units of a healthy fleet; says nothing where it exceeds 1."""
    since: int | None = None
    """Of a step: the number of the first drive after it."""
    since_range: tuple[int, int] | None = None
    """Of a step: the first and last credible number of that drive."""


@dataclass(frozen=True)
class FleetFit:
    """A parameter over the units that are not named."""

    within: Within
    between: Between | None
    """None with fewer than two units."""
    week_mean: float


@dataclass(frozen=True)
class Found:
    """What a fleet's parameters show."""

    named: list[str]
    """Units that differ from their fleet, the clearest first."""
    departures: dict[str, list[Departure]]
    """Of every unit, all departures whose p-value is below the false-alarm rate, or the smallest one alone; the clearest first."""
    fits: dict[str, FleetFit]
    """Of every parameter, over the units that are not named."""
    tests: int
    """How many tests a unit was put to."""


def find_departures(parameters: dict[str, list[Series]], false_alarm_rate: float = FALSE_ALARM_RATE) -> Found:
    """Tests every unit against its fleet and against what it was."""
    units = sorted({one.unit for fleet in parameters.values() for one in fleet})
    most = int(len(units) * LARGEST_SHARE_SET_ASIDE)
    aside: list[str] = []
    clear = 0
    while len(aside) < min(most, clear + MOST_MASKED):
        masked = len(aside) - clear
        found = _all_departures(_without(parameters, set(aside)), len(units) - len(aside))
        if not found:
            break
        aside.append(min(found, key=lambda unit: (found[unit][0].p_value, -abs(found[unit][0].t))))
        # So many sets could have been put aside before this unit was looked at; shares of the rate add up to one.
        choices = comb(len(units) - clear, masked)
        if found[aside[-1]][0].p_value * choices < false_alarm_rate * 0.5 ** (masked + 1):
            clear = len(aside)
    named = _confirmed(aside[:clear], parameters, len(units), false_alarm_rate)
    rest = _without(parameters, set(named))
    departures = {**named, **_all_departures(rest, len(units) - len(named))}
    kept = {unit: [one for one in all if one.p_value < false_alarm_rate] or all[:1] for unit, all in departures.items()}
    fits = {name: fleet_fit(fleet) for name, fleet in rest.items() if fleet}
    return Found(list(named), kept, fits, max((len(_tests(unit, parameters, fits)) for unit in units), default=0))


def _confirmed(
    aside: list[str], parameters: dict[str, list[Series]], units: int, false_alarm_rate: float
) -> dict[str, list[Departure]]:
    """Of the units that were set aside, those that differ from the fleet without the others, with their departures, the clearest first.

    A healthy unit may be set aside first where several ill ones widen the spread together; it goes back to the fleet.
    """
    candidates = list(aside)
    while True:
        fits = _fits(_without(parameters, set(candidates)))
        found = {unit: _departures_of(unit, parameters, fits, units) for unit in candidates}
        confirmed = {unit: all for unit, all in found.items() if all and all[0].p_value < false_alarm_rate}
        if len(confirmed) == len(candidates):
            return dict(sorted(confirmed.items(), key=lambda one: one[1][0].p_value))
        candidates = list(confirmed)


def _without(parameters: dict[str, list[Series]], units: set[str]) -> dict[str, list[Series]]:
    return {name: [one for one in fleet if one.unit not in units] for name, fleet in parameters.items()}


def fleet_fit(fleet: list[Series]) -> FleetFit:
    """The random-effects model of one parameter."""
    within = fit_within(fleet)
    weeks = np.concatenate([one.week for one in fleet])
    week_mean = float(np.mean(weeks)) if np.all(np.isfinite(weeks)) else 0.0
    means = np.array([unit_mean(one, within, week_mean) for one in fleet])
    between = fit_between(means[:, 0], means[:, 1]) if len(fleet) >= 2 else None
    return FleetFit(within, between, week_mean)


def _all_departures(parameters: dict[str, list[Series]], units: int) -> dict[str, list[Departure]]:
    """The departures of every unit from a fleet without it, or without a group that it is in."""
    names = sorted({one.unit for fleet in parameters.values() for one in fleet})
    found = {}
    for group in (names[i::MOST_GROUPS] for i in range(min(MOST_GROUPS, len(names)))):
        fits = _fits(_without(parameters, set(group)))
        found.update({unit: _departures_of(unit, parameters, fits, units) for unit in group})
    return {unit: departures for unit, departures in found.items() if departures}


def _fits(parameters: dict[str, list[Series]]) -> dict[str, FleetFit]:
    """The model of each parameter that enough units determine."""
    return {name: fleet_fit(fleet) for name, fleet in parameters.items() if len(fleet) >= FEWEST_UNITS - 1}


def _departures_of(unit: str, parameters: dict[str, list[Series]], fits: dict[str, FleetFit], units: int) -> list[Departure]:
    """All tests of a unit, the clearest first, their p-values as those of the clearest of so many."""
    departures = _tests(unit, parameters, fits)
    at_once = len(departures) * units
    adjusted = [replace(one, p_value=one.p_value * at_once) for one in departures]
    return sorted(adjusted, key=lambda one: (one.p_value, -abs(one.t)))


def _tests(unit: str, parameters: dict[str, list[Series]], fits: dict[str, FleetFit]) -> list[Departure]:
    departures: list[Departure | None] = []
    for name, fit in fits.items():
        own = next((one for one in parameters[name] if one.unit == unit), None)
        if own is None:
            continue
        departures.append(_level(name, own, fit))
        if own.dated and len(own.value) >= FEWEST_DRIVES and fit.within.dof >= 1:
            departures += [_step(name, own, fit.within), _drift(name, own, fit.within)]
    return [one for one in departures if one is not None]


def _level(name: str, own: Series, fit: FleetFit) -> Departure | None:
    mean, sigma = unit_mean(own, fit.within, fit.week_mean)
    between = fit.between
    if between is None or between.dof < 1:
        return None
    spread = float(np.hypot(np.hypot(between.tau, sigma), between.mean_sigma))
    t = (mean - between.mean) / spread
    return Departure(own.unit, name, "level", mean - between.mean, spread, t, float(2.0 * stats.t.sf(abs(t), between.dof)))


def _step(name: str, own: Series, within: Within) -> Departure | None:
    """The best place of a step between two drives."""
    value = own.value - within.slope_per_week * own.week
    weight = 1.0 / (own.sigma**2 + within.omega**2)
    sums = np.array([np.cumsum(weight), np.cumsum(weight * value)])
    before, after = sums[:, :-1], sums[:, -1:] - sums[:, :-1]
    size = after[1] / after[0] - before[1] / before[0]
    sigma = np.sqrt(1.0 / before[0] + 1.0 / after[0])
    # Drives of one day are not parted.
    possible = np.flatnonzero(np.diff(own.week) > 0.0)
    if len(possible) == 0:
        return None
    t = size / sigma
    best = possible[np.argmax(np.abs(t[possible]))]
    credible = possible[t[possible] ** 2 >= t[best] ** 2 - CREDIBLE_DEVIANCE]
    p_value = min(1.0, len(possible) * float(2.0 * stats.t.sf(abs(t[best]), within.dof)))
    since_range = (int(credible[0]) + 1, int(credible[-1]) + 1)
    return Departure(own.unit, name, "step", float(size[best]), float(sigma[best]), float(t[best]), p_value, int(best) + 1, since_range)


def _drift(name: str, own: Series, within: Within) -> Departure | None:
    weight = 1.0 / (own.sigma**2 + within.omega**2)
    week = own.week - np.sum(weight * own.week) / np.sum(weight)
    information = float(np.sum(weight * week * week))
    if not information > 0.0:
        return None
    slope = float(np.sum(weight * week * own.value)) / information - within.slope_per_week
    sigma = float(np.hypot(information**-0.5, np.nan_to_num(within.slope_sigma)))
    return Departure(own.unit, name, "drift", slope, sigma, slope / sigma, float(2.0 * stats.t.sf(abs(slope / sigma), within.dof)))
