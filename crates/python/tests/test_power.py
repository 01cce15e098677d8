"""Power over arrays: the one function that computes power, whatever the shape."""

from __future__ import annotations

import numpy
import pytest

import joulepath


def test_a_table_of_the_paper_is_met():
    # Dogru & Marques (2018): turning on the spot at 1 rad/s on marble took 106 W and 116 W.
    spin = joulepath.power("husky-a200", 0.0, 1.0, surface="marble")
    assert 100 < spin["power_left_w"] < 140 and 100 < spin["power_right_w"] < 140


def test_arrays_are_broadcast_and_each_moment_is_that_of_its_scalars():
    speeds_mps, pitches_rad = numpy.array([[0.3], [0.6]]), numpy.array([-0.1, 0.0, 0.2])
    found = joulepath.power("husky-a200", speeds_mps, 0.1, pitches_rad, roll_rad=0.05)
    assert found["power_w"].shape == (2, 3)
    for i, j in numpy.ndindex(2, 3):
        one = joulepath.power("husky-a200", float(speeds_mps[i, 0]), 0.1, float(pitches_rad[j]), 0.05)
        assert one["power_w"].shape == () and one["power_w"] == found["power_w"][i, j]


def test_left_and_right_turns_mirror_one_another_and_climbing_costs_its_height():
    robot = joulepath.Robot.builtin("husky-a200")
    even = robot.replace(motors={"right": robot.motors["left"]}, center_of_mass={"left_m": 0.0})
    left, right = (joulepath.power(even, 0.5, rate) for rate in (0.4, -0.4))
    assert left["power_left_w"] == pytest.approx(right["power_right_w"])
    climb = joulepath.power(even, 0.5, pitch_rad=0.2)["power_w"] - joulepath.power(even, 0.5)["power_w"]
    assert climb > even.mass_kg * 9.80665 * 0.5 * numpy.sin(0.2)


def test_no_moments_are_no_power():
    assert joulepath.power("husky-a200", numpy.empty(0))["power_w"].shape == (0,)


def test_a_million_moments_are_those_of_a_few():
    speeds_mps = numpy.tile(numpy.array([0.1, 0.5, 0.9]), 400_000)
    found = joulepath.power("husky-a200", speeds_mps)["power_w"]
    numpy.testing.assert_array_equal(found, numpy.tile(found[:3], 400_000))


def test_power_is_that_of_the_equations_written_once_more():
    import importlib.util
    import pathlib

    spec = importlib.util.spec_from_file_location("numpy_power", pathlib.Path(__file__).with_name("numpy_power.py"))
    numpy_power = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(numpy_power)
    random = numpy.random.default_rng(5)
    moments = 20_000
    speed_mps, yaw_rate_radps = random.uniform(-1, 1, moments), random.uniform(-1.5, 1.5, moments)
    pitch_rad, roll_rad = random.uniform(-0.4, 0.4, moments), random.uniform(-0.3, 0.3, moments)
    husky = joulepath.Robot.builtin("husky-a200").replace(motors={"regeneration": 0.6}, hotel_power_w=20.0)
    found = joulepath.power(husky, speed_mps, yaw_rate_radps, pitch_rad, roll_rad, surface="marble")
    expected = numpy_power.power_w(husky.to_dict(), "marble", speed_mps, yaw_rate_radps, pitch_rad, roll_rad)
    numpy.testing.assert_allclose(found["power_w"], expected, rtol=1e-9, atol=1e-9)
