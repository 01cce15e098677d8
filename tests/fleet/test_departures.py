"""Which units are named, which are not, and how often by mistake."""

import numpy as np
import pytest
from joulepath.fleet.departures import find_departures
from joulepath.fleet.random_effects import Series

WEEKS = 8
SPREAD, DRIVES, FIT = 0.1, 0.01, 0.01


def healthy(units, parameters=2, seed=0, weeks=WEEKS):
    """Series of a fleet as the model has it."""
    random = np.random.default_rng(seed)
    return {
        f"p{p}": [
            Series(
                f"u{i:02d}",
                random.normal(0.0, SPREAD) + random.normal(0.0, np.hypot(DRIVES, FIT), weeks),
                np.full(weeks, FIT),
                np.arange(weeks, dtype=float),
            )
            for i in range(units)
        ]
        for p in range(parameters)
    }


def changed(fleet, unit, parameter, by):
    """The same fleet with one series changed."""
    return {
        name: [
            Series(one.unit, one.value + by, one.sigma, one.week) if (one.unit, name) == (unit, parameter) else one for one in all
        ]
        for name, all in fleet.items()
    }


def test_fleets_with_none_to_name_are_given_a_name_no_more_often_than_stated():
    alarms = sum(bool(find_departures(healthy(10, seed=seed), 0.2).named) for seed in range(20))
    # 11 of 20 and more have a chance of 0.0006 at a rate of 0.2.
    assert alarms < 11


def test_a_unit_beyond_the_fleet_is_named_by_its_level():
    found = find_departures(changed(healthy(20), "u07", "p1", 10.0 * SPREAD))
    assert found.named == ["u07"]
    foremost = found.departures["u07"][0]
    assert (foremost.parameter, foremost.kind) == ("p1", "level")
    assert foremost.size == pytest.approx(10.0 * SPREAD, rel=0.5)


def test_a_change_within_the_spread_of_the_fleet_is_named_with_the_drive_since_when():
    step = np.where(np.arange(WEEKS) >= 5, 0.1, 0.0)
    found = find_departures(changed(healthy(20), "u03", "p0", step))
    assert found.named == ["u03"]
    foremost = found.departures["u03"][0]
    assert (foremost.parameter, foremost.kind, foremost.since, foremost.since_range) == ("p0", "step", 5, (5, 5))
    assert abs(foremost.size - 0.1) < 4.0 * foremost.sigma


def test_ill_units_do_not_hide_one_another():
    fleet = healthy(20)
    for unit, by in (("u01", 1.5), ("u02", 1.4), ("u03", 1.6)):
        fleet = changed(fleet, unit, "p0", by)
    assert sorted(find_departures(fleet).named) == ["u01", "u02", "u03"]


def test_what_the_whole_fleet_does_is_nobodys_departure():
    fleet = healthy(12)
    for unit in [one.unit for one in fleet["p0"]]:
        fleet = changed(fleet, unit, "p0", 0.05 * np.arange(WEEKS))
    found = find_departures(fleet)
    assert found.named == []
    assert found.fits["p0"].within.slope_per_week == pytest.approx(0.05, abs=0.005)


def test_figures_of_the_fleet_are_those_without_the_named():
    found = find_departures(changed(healthy(20), "u07", "p1", 10.0 * SPREAD))
    assert found.fits["p1"].between.tau == pytest.approx(SPREAD, rel=0.5)


def test_three_units_are_too_few_to_tell_which_is_odd():
    found = find_departures(changed(healthy(3), "u00", "p0", 5.0))
    assert found.named == []
    assert found.departures == {}


def test_series_without_dates_are_compared_by_level_alone():
    fleet = {name: [Series(one.unit, one.value, one.sigma, np.full(WEEKS, np.nan)) for one in all] for name, all in healthy(20).items()}
    found = find_departures(changed(fleet, "u07", "p1", 10.0 * SPREAD))
    assert found.named == ["u07"]
    assert {one.kind for all in found.departures.values() for one in all} == {"level"}
