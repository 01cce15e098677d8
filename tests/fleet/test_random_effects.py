"""The random-effects model against published figures and closed forms."""

import numpy as np
import pytest
from joulepath.fleet.random_effects import Series, fit_between, fit_within, unit_mean

# Log risk ratios and variances of 13 trials of the BCG vaccine (Colditz et al., JAMA 271, 1994), as meta-analysis software is checked with.
BCG_MEAN = [-0.8893, -1.5854, -1.3481, -1.4416, -0.2175, -0.7861, -1.6209, 0.0120, -0.4694, -1.3713, -0.3394, 0.4459, -0.0173]
BCG_VARIANCE = [0.3256, 0.1946, 0.4154, 0.0200, 0.0512, 0.0069, 0.2230, 0.0040, 0.0564, 0.0730, 0.0124, 0.5325, 0.0714]


def series(unit, value, sigma=1e-6, week=None):
    value = np.asarray(value, float)
    return Series(unit, value, np.full(len(value), sigma), np.arange(len(value), dtype=float) if week is None else np.asarray(week, float))


def test_mean_and_spread_over_units_are_those_that_metafor_prints():
    found = fit_between(np.array(BCG_MEAN), np.sqrt(BCG_VARIANCE))
    assert found.tau**2 == pytest.approx(0.3132, abs=2e-4)
    assert found.mean == pytest.approx(-0.7145, abs=2e-4)
    assert found.mean_sigma == pytest.approx(0.1807, abs=2e-4)
    assert found.dof == 12


def test_balanced_drives_without_fit_errors_give_the_variances_of_a_one_way_analysis():
    random = np.random.default_rng(3)
    values = random.normal(0.0, 2.0, (8, 1)) + random.normal(0.0, 0.5, (8, 5))
    # Without dates there is no shared drift to estimate.
    fleet = [series(str(i), row, week=[np.nan] * 5) for i, row in enumerate(values)]
    within = fit_within(fleet)
    assert within.omega**2 == pytest.approx(np.mean(np.var(values, axis=1, ddof=1)), rel=1e-3)
    means = np.array([unit_mean(one, within, 0.0) for one in fleet])
    between = fit_between(means[:, 0], means[:, 1])
    assert between.tau**2 == pytest.approx(np.var(values.mean(axis=1), ddof=1) - within.omega**2 / 5, rel=1e-3)


def test_a_drift_that_all_units_share_is_found_with_its_size():
    random = np.random.default_rng(4)
    fleet = [series(str(i), i + 0.02 * np.arange(10) + random.normal(0.0, 0.01, 10)) for i in range(12)]
    found = fit_within(fleet)
    assert abs(found.slope_per_week - 0.02) < 4.0 * found.slope_sigma < 0.002


def test_units_that_agree_better_than_their_errors_let_them_have_no_spread():
    found = fit_between(np.array([1.0, 1.01, 0.99, 1.0]), np.full(4, 0.5))
    assert found.tau == 0.0
    assert found.mean_sigma == pytest.approx(0.25)


def test_a_single_drive_of_each_unit_tells_nothing_of_drives():
    found = fit_within([series("a", [1.0]), series("b", [2.0])])
    assert (found.omega, found.dof) == (0.0, 0)
