"""What is driven: straights, arcs, spins and stops as a reference in time, and a pilot that follows it."""

import math
from dataclasses import dataclass

import numpy as np

STEP_S = 0.1
# The ground reaches 32 m from the middle.
REACH_M = 24.0
SPEEDS_MPS = (0.3, 0.9)
# Faster changes would be mostly inertia.
ACCELERATION_MPS2 = 0.4
YAW_ACCELERATION_RADPS2 = 0.8
MOST_RIM_MPS = 1.0
# Wheels that skid turn the robot less than their speeds say: Clearpath's own controller for the Husky takes the track
# times 1.875, and these wheels come near it: 1.5 to 1.7, measured.
STEERING_TRACK_M = 0.5708 * 1.7
# Gentle gains of Kanayama et al., A stable tracking control method for an autonomous mobile robot (ICRA 1990):
# errors along, across and in heading fade over some seconds, so that drives with and without an effect stay together.
ALONG_PER_S = 0.3
# Bullet's wheels skid at their full friction however little they are steered: a pilot that trembled about straight ahead
# would scuff all along, as none does that gives its commands in steps.
STEERS_FROM_MPS = 0.02
ACROSS_PER_M2 = 0.5
TURN_PER_M = 1.5
TURN_PER_S = 0.5


@dataclass(frozen=True)
class Course:
    """Where the robot shall be, every tenth of a second."""

    x_m: np.ndarray
    y_m: np.ndarray
    heading_rad: np.ndarray
    speed_mps: np.ndarray
    yaw_rate_radps: np.ndarray


def _leg(random: np.random.Generator) -> tuple[float, float, float]:
    """Speed, yaw rate and duration of a leg."""
    kind = random.choice(["straight", "arc", "spin", "stop"], p=[0.42, 0.32, 0.18, 0.08])
    speed_mps = random.uniform(*SPEEDS_MPS)
    side = random.choice([-1.0, 1.0])
    if kind == "straight":
        return speed_mps, 0.0, random.uniform(6.0, 16.0)
    if kind == "arc":
        speed_mps = min(speed_mps, 0.7)
        radius_m = math.exp(random.uniform(math.log(0.8), math.log(6.0)))
        # The outer wheels must stay within what the robot can do.
        yaw_rate_radps = min(speed_mps / radius_m, 2.0 * (MOST_RIM_MPS - 0.1 - speed_mps) / STEERING_TRACK_M)
        return speed_mps, side * yaw_rate_radps, random.uniform(5.0, 12.0)
    if kind == "spin":
        return 0.0, side * random.uniform(0.4, 1.0), random.uniform(3.0, 8.0)
    return 0.0, 0.0, random.uniform(2.0, 4.0)


def _ramp(now: float, goal: float, most: float) -> float:
    return now + min(max(goal - now, -most), most)


def _follow(state: list[float], goal: tuple[float, float, float]) -> list[list[float]]:
    """States of a leg: x, y, heading, speed and yaw rate."""
    states = []
    x_m, y_m, heading_rad, speed_mps, yaw_rate_radps = state
    for _ in range(round(goal[2] / STEP_S)):
        speed_mps = _ramp(speed_mps, goal[0], ACCELERATION_MPS2 * STEP_S)
        yaw_rate_radps = _ramp(yaw_rate_radps, goal[1], YAW_ACCELERATION_RADPS2 * STEP_S)
        x_m += speed_mps * math.cos(heading_rad) * STEP_S
        y_m += speed_mps * math.sin(heading_rad) * STEP_S
        heading_rad += yaw_rate_radps * STEP_S
        states.append([x_m, y_m, heading_rad, speed_mps, yaw_rate_radps])
    return states


def draw(seed: int, duration_s: float) -> Course:
    """A random course that stays on the ground."""
    random = np.random.default_rng([seed, 2])
    states = [[0.0, 0.0, random.uniform(-math.pi, math.pi), 0.0, 0.0]]
    while len(states) * STEP_S < duration_s:
        leg = _follow(states[-1], _leg(random))
        # Legs that would leave the ground are drawn anew; at the edge spins come up until one faces inwards.
        if all(math.hypot(s[0] + 1.5 * math.cos(s[2]), s[1] + 1.5 * math.sin(s[2])) < REACH_M or s[3] == 0.0 for s in leg):
            states.extend(leg)
    return Course(*np.array(states[: round(duration_s / STEP_S)]).T)


def rim_speeds(course: Course, step: int, pose: tuple[float, float, float]) -> tuple[float, float]:
    """Rim speeds, left and right, that bring a robot at a pose back to its course."""
    speed_mps, yaw_rate_radps = course.speed_mps[step], course.yaw_rate_radps[step]
    east_m, north_m = course.x_m[step] - pose[0], course.y_m[step] - pose[1]
    along_m = math.cos(pose[2]) * east_m + math.sin(pose[2]) * north_m
    across_m = -math.sin(pose[2]) * east_m + math.cos(pose[2]) * north_m
    turn_rad = math.remainder(course.heading_rad[step] - pose[2], 2.0 * math.pi)
    if speed_mps == 0.0 and yaw_rate_radps == 0.0:
        return 0.0, 0.0
    moving = min(1.0, speed_mps / SPEEDS_MPS[0])
    forward_mps = speed_mps * math.cos(turn_rad) + ALONG_PER_S * along_m * moving
    steer_radps = yaw_rate_radps + TURN_PER_S * turn_rad
    steer_radps += speed_mps * (ACROSS_PER_M2 * across_m + TURN_PER_M * math.sin(turn_rad))
    half_mps = min(max(steer_radps * STEERING_TRACK_M / 2, -0.7), 0.7)
    if abs(half_mps) < STEERS_FROM_MPS:
        half_mps = 0.0
    forward_mps = min(max(forward_mps, -MOST_RIM_MPS + abs(half_mps)), MOST_RIM_MPS - abs(half_mps))
    return forward_mps - half_mps, forward_mps + half_mps
