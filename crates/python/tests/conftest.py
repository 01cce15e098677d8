"""Maps and drives that several tests ask about."""

from __future__ import annotations

import numpy
import pytest

import joulepath


@pytest.fixture(scope="session")
def hill() -> joulepath.Map:
    """A smooth hill of 4 m in the middle of 30 m by 20 m."""
    y_m, x_m = numpy.mgrid[0:40, 0:60] * 0.5 + 0.25
    z_m = 4.0 * numpy.exp(-((x_m - 15.0) ** 2 + (y_m - 10.0) ** 2) / 30.0)
    return joulepath.Map.from_array(z_m, 0.5, crs="EPSG:32632")


@pytest.fixture(scope="session")
def planner(hill: joulepath.Map) -> joulepath.Planner:
    return joulepath.Planner(hill, "husky-a200")


@pytest.fixture(scope="session")
def drive() -> dict[str, numpy.ndarray]:
    """Two minutes of turning and driving on level ground, whose power is the model's and 3 W of noise."""
    t_s = numpy.arange(0.0, 120.0, 0.1)
    left_mps = 0.4 + 0.2 * numpy.sin(t_s / 7.0)
    right_mps = 0.4 + 0.2 * numpy.cos(t_s / 5.0)
    husky = joulepath.Robot.builtin("husky-a200")
    speed_mps, yaw_rate_radps = (left_mps + right_mps) / 2, (right_mps - left_mps) / husky.slip_track_m
    power_w = joulepath.power(husky, speed_mps, yaw_rate_radps)["power_w"]
    noise_w = numpy.random.default_rng(1).normal(0.0, 3.0, len(t_s))
    return {"t_s": t_s, "v_left_mps": left_mps, "v_right_mps": right_mps, "power_w": power_w + noise_w}


@pytest.fixture(scope="session")
def simulated() -> joulepath.Simulation:
    """Five minutes of a rich drive over gentle hills, with a payload that the robot file does not know."""
    world = {"terrain": {"rolling": {"grade": 0.06}}, "seed": 3, "effects": [{"effect": "payload", "strength": 25.0}]}
    return joulepath.simulate(world, {"kind": "rich", "duration_s": 300, "seed": 3}, key=True)
