"""The force balance written once more over numpy arrays, for a centred robot without mechanisms: an oracle, and a peer in speed."""

from __future__ import annotations

from typing import Any

import numpy

#: Standard acceleration of free fall [m/s²] (CGPM 1901).
GRAVITY_MPS2 = 9.80665
#: Rim speed at which rolling resistance turns round [m/s].
TURNAROUND_MPS = 0.001
#: Least square of the mobilised share of skid that the sideways pull is divided by [-].
LEAST_CALLED_UP = 1e-4


def power_w(robot: dict[str, Any], surface: str, speed_mps: Any, yaw_rate_radps: Any, pitch_rad: Any, roll_rad: Any) -> Any:
    """Power drawn from the battery at the motors' reference temperature [W]."""
    ground = robot["surfaces"][surface]
    weight_n, half_slip_m = robot["mass_kg"] * GRAVITY_MPS2, robot["slip_track_m"] / 2
    along, normal, tilt = numpy.sin(pitch_rad), numpy.cos(pitch_rad) * numpy.cos(roll_rad), numpy.tan(roll_rad)
    skid_n = weight_n * _skid_share(robot, ground, speed_mps, yaw_rate_radps, tilt)
    regeneration, drawn_w = robot["motors"]["regeneration"], 0.0
    for side, sign in (("left", -1.0), ("right", 1.0)):
        rim_mps = speed_mps + sign * half_slip_m * yaw_rate_radps
        rolling_n = 0.5 * weight_n * ground["mu_roll"] * numpy.tanh(rim_mps / TURNAROUND_MPS)
        force_n = (rolling_n + sign * skid_n) * normal + 0.5 * weight_n * along
        motor = robot["motors"][side]
        factor = numpy.where((force_n >= 0) == (rim_mps >= 0), motor["k2"], regeneration / motor["k2"])
        drawn_w = drawn_w + motor["k1_w_per_n2"] * force_n**2 + factor * rim_mps * force_n
        drawn_w = drawn_w + numpy.where(rim_mps == 0, 0.0, robot["drive_electronics_w"])
    least_k2 = min(robot["motors"][side]["k2"] for side in ("left", "right"))
    lift_w = weight_n * speed_mps * along
    floor_w = lift_w * numpy.where(lift_w >= 0, least_k2, regeneration / least_k2)
    return numpy.maximum(drawn_w, floor_w) + robot["hotel_power_w"]


def _skid_share(robot: dict[str, Any], ground: dict[str, Any], speed_mps: Any, yaw_rate_radps: Any, tilt: Any) -> Any:
    """Force of the skid on each side, as a share of the weight on the ground."""
    across_mps, half_track_m = numpy.abs(yaw_rate_radps * robot["wheelbase_m"] / 2), robot["track_m"] / 2
    mobilized = 0.0
    for sign in (1.0, -1.0):
        slip_rad = numpy.arctan2(across_mps, numpy.abs(speed_mps - sign * half_track_m * yaw_rate_radps))
        mobilized = mobilized + 0.5 * numpy.tanh(slip_rad / ground["slip_angle_scale_rad"])
    squared = numpy.maximum(mobilized**2, LEAST_CALLED_UP)
    share = numpy.minimum((tilt / ground["mu_skid"]) ** 2, 1.0)
    root = numpy.sqrt(4.0 * share * squared + (1.0 - squared) ** 2)
    left = 1.0 + (1.0 - squared - root) / (2.0 * squared)
    arm_m = 0.5 * robot["wheelbase_m"] * mobilized * numpy.sign(yaw_rate_radps)
    return arm_m * ground["mu_skid"] / robot["track_m"] * left
