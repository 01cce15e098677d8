"""One drive through Bullet's world, as the truth about every tenth of a second."""

import math
from dataclasses import dataclass

import numpy as np
import pybullet

import course as courses
import ground as grounds
from effects import Effects
from husky import GRAVITY_MPS2, ROLL, ROLLING_RADIUS_M, SKID, Husky

# Bullet's own step. Steps of 1/480 s gave the same forces in twice the time.
STEP_S = 1.0 / 240.0
STEPS_PER_ROW = 24
ITERATIONS = 50
SETTLE_S = 1.0
# Loads of wheels and friction follow slower things than steps are.
STEPS_PER_LOOK = 6


@dataclass(frozen=True)
class Trip:
    """What is driven where."""

    seed: int
    duration_s: float
    effects: Effects = Effects()


def _attitude(body: int) -> tuple[tuple[float, float, float], list[float]]:
    """Position and rotation matrix of the body, row by row."""
    position, turned = pybullet.getBasePositionAndOrientation(body)
    return position, list(pybullet.getMatrixFromQuaternion(turned))


class Means:
    """Means over a row, as its steps go by."""

    def __init__(self) -> None:
        self.force_n = np.zeros(2)
        self.speed_mps = np.zeros(2)
        self.yaw_rate_radps = 0.0

    def add(self, body: int, states: list[tuple], matrix: list[float]) -> None:
        """One step's share of the means."""
        torque_nm = [state[3] for state in states]
        speed_radps = [state[1] for state in states]
        self.force_n += np.array([sum(torque_nm[:2]), sum(torque_nm[2:])]) / ROLLING_RADIUS_M / STEPS_PER_ROW
        self.speed_mps += np.array([sum(speed_radps[:2]), sum(speed_radps[2:])]) * ROLLING_RADIUS_M / 2 / STEPS_PER_ROW
        turn = pybullet.getBaseVelocity(body)[1]
        self.yaw_rate_radps += (turn[0] * matrix[2] + turn[1] * matrix[5] + turn[2] * matrix[8]) / STEPS_PER_ROW


def connect() -> None:
    """Starts an empty world; to be disconnected."""
    pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation()
    pybullet.setGravity(0.0, 0.0, -GRAVITY_MPS2)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP_S, numSolverIterations=ITERATIONS, deterministicOverlappingPairs=1)


def _row(robot: Husky, ground: int, trip: Trip, commands: list[np.ndarray]) -> list[float]:
    """Drives a row: commands change evenly from the first to the second. Returns the row's truth."""
    means = Means()
    effects = trip.effects
    roll = ROLL
    for step in range(STEPS_PER_ROW):
        if step % STEPS_PER_LOOK == 0:
            position, matrix = _attitude(robot.body)
            velocity = pybullet.getBaseVelocity(robot.body)[0]
            wind_n = effects.wind_n(velocity[:2])
            if effects.roll_change or effects.skid_change:
                other = effects.other_ground(position[0])
                roll = ROLL * (1.0 + effects.roll_change * other)
                robot.skid(SKID * (1.0 + effects.skid_change * other))
        share = (step + 1) / STEPS_PER_ROW
        robot.command(tuple(commands[0] + share * (commands[1] - commands[0])))
        states = pybullet.getJointStates(robot.body, robot.wheels)
        robot.resist([matrix[1], matrix[4], matrix[7]], [state[1] for state in states], roll, effects)
        if wind_n != (0.0, 0.0):
            # At the middle of the chassis, whose collision box is centred 0.27 m above the ground.
            middle = [position[0], position[1], position[2] + 0.27]
            pybullet.applyExternalForce(robot.body, -1, [*wind_n, 0.0], middle, pybullet.WORLD_FRAME)
        pybullet.stepSimulation()
        robot.weigh(ground, STEP_S)
        means.add(robot.body, pybullet.getJointStates(robot.body, robot.wheels), matrix)
    position, matrix = _attitude(robot.body)
    pitch_rad = math.asin(matrix[6])
    roll_rad = math.atan2(matrix[7], matrix[8])
    heading_rad = math.atan2(matrix[3], matrix[0])
    return [*means.force_n, *means.speed_mps, means.yaw_rate_radps, pitch_rad, roll_rad, *position, heading_rad]


COLUMNS = ("force_left_n", "force_right_n", "v_left_mps", "v_right_mps", "yaw_rate_radps", "pitch_rad", "roll_rad",
           "x_m", "y_m", "z_m", "heading_rad")


def drive(trip: Trip) -> dict[str, np.ndarray]:
    """Drives a trip; returns columns of truth."""
    connect()
    try:
        plan = courses.draw(trip.seed, trip.duration_s)
        ground = grounds.make(trip.seed)
        start_m = [plan.x_m[0], plan.y_m[0], ground.height_at(plan.x_m[0], plan.y_m[0]) + 0.05]
        robot = Husky(start_m, plan.heading_rad[0])
        robot.load(trip.effects.payload_kg)
        stand = [np.zeros(2), np.zeros(2)]
        for _ in range(round(SETTLE_S / courses.STEP_S)):
            row = _row(robot, ground.body, trip, stand)
        rows, command = [], np.zeros(2)
        for step in range(len(plan.x_m)):
            wanted = np.array(courses.rim_speeds(plan, step, (row[7], row[8], row[10])))
            row = _row(robot, ground.body, trip, [command, wanted])
            command = wanted
            rows.append(row)
        return dict(zip(COLUMNS, np.array(rows).T))
    finally:
        pybullet.disconnect()
