"""PyBullet's own Husky: what its file says, and forces on its wheels that Bullet lacks."""

import contextlib
import math
import os
import sys
from collections.abc import Iterator

import numpy as np
import pybullet
import pybullet_data

from effects import CREEP_MPS, Effects

GRAVITY_MPS2 = 9.81
WHEELS = {"left": ("front_left_wheel", "rear_left_wheel"), "right": ("front_right_wheel", "rear_right_wheel")}
# Path per wheel angle, measured over 10 s at 0.5 m/s on level ground: the cylinder of 0.17775 m and Bullet's margin about it.
ROLLING_RADIUS_M = 0.1784
# Grip along the wheel as the robot's file has it; across, the skid friction of a Husky on marble (Dogru & Marques,
# T-RO 2018, Table II). Equal grip both ways left Bullet's robot hardly able to turn: 0.3 of the rate that its wheels said.
GRIP = 1.0
SKID = 0.30
# Rolling resistance of the same table. It is put on as a moment against each wheel, in proportion to Bullet's own contact
# force: Bullet's rolling friction acts at every point of a changing contact, and the drag of straights wandered by 30 %.
ROLL = 0.063
# Bullet's contact forces chatter from step to step; a wheel's load changes with the ground, over a second.
LOAD_MEMORY_S = 0.1
# Of each wheel: half as much again as turns take, and no more than its grip passes on. Without a limit, a wheel that catches on
# an edge of the ground draws a kilowatt.
MOST_TORQUE_NM = 20.0


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Without what Bullet prints about links that have no mass in the robot's file."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


class Husky:
    """The robot in the connected world."""

    def __init__(self, position_m: list[float], heading_rad: float) -> None:
        pybullet.setAdditionalSearchPath(pybullet_data.getDataPath())
        turned = pybullet.getQuaternionFromEuler([0.0, 0.0, heading_rad])
        with quiet():
            self.body = pybullet.loadURDF("husky/husky.urdf", position_m, turned)
        names = {pybullet.getJointInfo(self.body, j)[1].decode(): j for j in range(pybullet.getNumJoints(self.body))}
        self.wheels = [names[name] for side in WHEELS.values() for name in side]
        self.chassis, self.top = names["chassis_joint"], names["top_plate"]
        self.load_n = [self.mass_kg() * GRAVITY_MPS2 / 4] * 4
        # Air and joints without losses: every loss is one that stands in these files.
        pybullet.changeDynamics(self.body, -1, linearDamping=0.0, angularDamping=0.0)
        self.friction = 0.0
        self.skid(SKID)

    def skid(self, friction: float) -> None:
        """Sets the friction across the wheels; y is the axle."""
        if friction == self.friction:
            return
        self.friction = friction
        for wheel in self.wheels:
            pybullet.changeDynamics(
                self.body, wheel, lateralFriction=GRIP, rollingFriction=0.0, spinningFriction=0.0,
                anisotropicFriction=[1.0, friction / GRIP, 1.0],
            )

    def load(self, mass_kg: float) -> None:
        """Puts a load onto the top plate."""
        bare_kg = pybullet.getDynamicsInfo(self.body, self.top)[0]
        pybullet.changeDynamics(self.body, self.top, mass=bare_kg + mass_kg)

    def _links(self) -> list[int]:
        return [-1, *range(pybullet.getNumJoints(self.body))]

    def mass_kg(self) -> float:
        """Mass as Bullet has it, links without a mass in the file at 1 kg each included."""
        return sum(pybullet.getDynamicsInfo(self.body, link)[0] for link in self._links())

    def measures(self) -> dict[str, float | dict[str, float]]:
        """What a robot file of joulepath holds about the body, read while the robot stands unturned at the origin."""
        masses, places, inertias = [], [], []
        for link in self._links():
            info = pybullet.getDynamicsInfo(self.body, link)
            place = pybullet.getBasePositionAndOrientation(self.body) if link < 0 else pybullet.getLinkState(self.body, link)
            masses.append(info[0])
            places.append(place[0])
            inertias.append(info[2][2])
        mass, place = np.array(masses), np.array(places)
        hub = np.array([pybullet.getLinkState(self.body, wheel)[4] for wheel in self.wheels])
        centre = mass @ place / mass.sum()
        middle = hub.mean(axis=0)
        about = ((place - centre)[:, :2] ** 2).sum(axis=1)
        return {
            "mass_kg": float(mass.sum()),
            "wheelbase_m": float(np.ptp(hub[:, 0])),
            "track_m": float(np.ptp(hub[:, 1])),
            "wheel_radius_m": ROLLING_RADIUS_M,
            "yaw_inertia_kgm2": float(np.sum(inertias) + mass @ about),
            "center_of_mass": {
                "forward_m": float(centre[0] - middle[0]),
                "left_m": float(centre[1] - middle[1]),
                "height_m": float(centre[2] - middle[2] + ROLLING_RADIUS_M),
            },
        }

    def command(self, rim_mps: tuple[float, float]) -> None:
        """Speeds of the rims, left and right, to Bullet's velocity motors."""
        speeds = [rim / ROLLING_RADIUS_M for rim in rim_mps for _ in range(2)]
        pybullet.setJointMotorControlArray(
            self.body, self.wheels, pybullet.VELOCITY_CONTROL, targetVelocities=speeds, forces=[MOST_TORQUE_NM] * 4
        )

    def weigh(self, ground: int, seconds: float) -> None:
        """Follows the contact force under each wheel."""
        now_n = dict.fromkeys(self.wheels, 0.0)
        for point in pybullet.getContactPoints(self.body, ground):
            if point[3] in now_n:
                now_n[point[3]] += point[9]
        share = seconds / LOAD_MEMORY_S
        self.load_n = [old + share * (now_n[wheel] - old) for old, wheel in zip(self.load_n, self.wheels)]

    def resist(self, axle: list[float], speed_radps: list[float], roll: float, effects: Effects) -> None:
        """Rolling resistance by the ground, and a brake that drags between chassis and the wheels of a side."""
        for i, (wheel, speed) in enumerate(zip(self.wheels, speed_radps)):
            direction = math.tanh(speed * ROLLING_RADIUS_M / CREEP_MPS)
            brake_nm = direction * (effects.drag_left_n, effects.drag_right_n)[i // 2] / 2 * ROLLING_RADIUS_M
            rolling_nm = direction * roll * self.load_n[i] * ROLLING_RADIUS_M
            against = [-(brake_nm + rolling_nm) * a for a in axle]
            pybullet.applyExternalTorque(self.body, wheel, against, pybullet.WORLD_FRAME)
            if brake_nm != 0.0:
                pybullet.applyExternalTorque(self.body, self.chassis, [brake_nm * a for a in axle], pybullet.WORLD_FRAME)
