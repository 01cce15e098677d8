"""A parameter over a fleet: a random-effects model of units and their drives.

    y_ij = mu + u_i + beta (t_ij - t_mean) + d_ij + e_ij

y a parameter that was fitted to drive j of unit i, or its logarithm; mu the mean of the fleet; u ~ N(0, tau^2) what is the unit's own; beta the
drift that all units share [1/week]; d ~ N(0, omega^2) what differs from drive to drive beyond the fit's own error; e ~ N(0, s_ij^2) that error,
known from the fit. omega and beta follow from differences within units, tau and mu from the units' means, each by restricted maximum
likelihood (Patterson & Thompson, Biometrika 58, 1971, doi:10.1093/biomet/58.3.545; DerSimonian & Laird's model of 1986 with REML in the place of
moments). The interval of mu is that of Hartung & Knapp (Statistics in Medicine 20, 2001, doi:10.1002/sim.791).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

Array = NDArray[np.float64]

LARGEST_SPREAD_RATIO = 10.0
"""The largest spread that is looked for, as a multiple of the standard deviation of the data, which bounds what REML can find."""


@dataclass(frozen=True)
class Series:
    """One parameter of one unit: a value for each drive that determines it, in the order of their dates."""

    unit: str
    value: Array
    """Fitted values, or their logarithms."""
    sigma: Array
    """Standard errors of the fits, in the same unit."""
    week: Array
    """When the drives were, in weeks since the fleet's first; NaN where that is not known."""

    @property
    def dated(self) -> bool:
        """Whether all its drives have a date."""
        return bool(np.all(np.isfinite(self.week)))


@dataclass(frozen=True)
class Within:
    """What differs from drive to drive of one unit."""

    omega: float
    """Standard deviation beyond the fits' own errors."""
    slope_per_week: float
    """Drift that all units share; 0 where fewer than three units or weeks tell of it."""
    slope_sigma: float
    """Its standard error; NaN where it is not estimated."""
    dof: int
    """Degrees of freedom that both follow from."""


@dataclass(frozen=True)
class Between:
    """What differs from unit to unit."""

    mean: float
    """Mean of the fleet."""
    mean_sigma: float
    """Standard error of the mean, by Hartung and Knapp."""
    tau: float
    """Standard deviation over the units."""
    dof: int
    """Degrees of freedom of the mean."""

    def mean_interval_95(self) -> tuple[float, float]:
        """The 95 % interval of the mean."""
        half = stats.t.ppf(0.975, self.dof) * self.mean_sigma
        return self.mean - half, self.mean + half


def fit_within(fleet: list[Series]) -> Within:
    """Estimates omega and the shared drift by restricted maximum likelihood over differences within units."""
    value = np.concatenate([one.value for one in fleet])
    variance = np.concatenate([one.sigma for one in fleet]) ** 2
    unit = np.repeat(np.arange(len(fleet)), [len(one.value) for one in fleet])
    week = np.concatenate([one.week for one in fleet])
    drifts = len(fleet) >= 3 and bool(np.all(np.isfinite(week))) and len(np.unique(week)) >= 3
    dof = len(value) - len(fleet) - int(drifts)
    if dof < 1:
        return Within(0.0, 0.0, np.nan, 0)

    def profile(omega: float) -> tuple[float, float, float]:
        """Twice the negative log restricted likelihood, the slope and its standard error."""
        weight = 1.0 / (variance + omega**2)
        total = np.bincount(unit, weight)

        def centred(x: Array) -> Array:
            return x - (np.bincount(unit, weight * x) / total)[unit]

        y = centred(value)
        slope, slope_sigma, determinant = 0.0, np.nan, 0.0
        if drifts:
            x = centred(week)
            information = float(np.sum(weight * x * x))
            slope, slope_sigma, determinant = float(np.sum(weight * x * y)) / information, information**-0.5, np.log(information)
            y = y - slope * x
        deviance = float(np.sum(weight * y * y) - np.sum(np.log(weight)) + np.sum(np.log(total))) + determinant
        return deviance, slope, slope_sigma

    omega = _least(lambda omega: profile(omega)[0], float(np.std(value)))
    _, slope, slope_sigma = profile(omega)
    return Within(omega, slope, slope_sigma, dof)


def unit_mean(one: Series, within: Within, week_mean: float) -> tuple[float, float]:
    """Returns the mean of a unit's drives, freed from the shared drift, with its standard error."""
    weight = 1.0 / (one.sigma**2 + within.omega**2)
    value = one.value - within.slope_per_week * (one.week - week_mean) if within.slope_per_week else one.value
    return float(np.sum(weight * value) / np.sum(weight)), float(np.sum(weight) ** -0.5)


def fit_between(mean: Array, sigma: Array) -> Between:
    """Estimates the fleet's mean and spread from the means of at least two units and their standard errors."""

    def deviance(tau: float) -> float:
        weight = 1.0 / (sigma**2 + tau**2)
        centre = np.sum(weight * mean) / np.sum(weight)
        return float(np.sum(weight * (mean - centre) ** 2) - np.sum(np.log(weight)) + np.log(np.sum(weight)))

    tau = _least(deviance, float(np.std(mean)))
    weight = 1.0 / (sigma**2 + tau**2)
    centre = float(np.sum(weight * mean) / np.sum(weight))
    dof = len(mean) - 1
    # Not below the standard error of the model: few units that happen to agree do not know the mean better than their own errors let them.
    factor = max(1.0, float(np.sum(weight * (mean - centre) ** 2)) / dof)
    return Between(centre, float((factor / np.sum(weight)) ** 0.5), tau, dof)


def _least(deviance: Callable[[float], float], scale: float) -> float:
    """Returns the non-negative spread of least deviance."""
    if not scale > 0.0:
        return 0.0
    found = optimize.minimize_scalar(
        lambda share: deviance(share * scale), bounds=(0.0, LARGEST_SPREAD_RATIO), method="bounded", options={"xatol": 1e-4}
    )
    # The search never ends on its bound, where the least often lies.
    return 0.0 if deviance(0.0) <= found.fun else float(found.x) * scale
