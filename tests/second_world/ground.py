"""Rolling ground: a random sum of waves as a Bullet heightfield."""

import math
from dataclasses import dataclass

import numpy as np
import pybullet

# A Husky's wheelbase. Edges between cells drag: cells of 0.125 m added 50 % to the rolling resistance, these 20 %.
CELL_M = 0.5
SIDE_CELLS = 128
# Root mean square slope and wavelengths of gentle pasture; steepest climbs come to about 0.1 rad.
GRADE = 0.04
WAVELENGTHS_M = (12.0, 30.0)
WAVES = 8


@dataclass(frozen=True)
class Ground:
    """Heights over a square around the origin."""

    body: int
    height_m: np.ndarray

    def height_at(self, x_m: float, y_m: float) -> float:
        """Height of the nearest grid point."""
        middle = (SIDE_CELLS - 1) / 2
        return float(self.height_m[round(y_m / CELL_M + middle), round(x_m / CELL_M + middle)])


def heights(seed: int) -> np.ndarray:
    """Heights in metres, rows from the south."""
    random = np.random.default_rng([seed, 1])
    axis_m = (np.arange(SIDE_CELLS) - (SIDE_CELLS - 1) / 2) * CELL_M
    x_m, y_m = np.meshgrid(axis_m, axis_m)
    height_m = np.zeros_like(x_m)
    for _ in range(WAVES):
        length_m = random.uniform(*WAVELENGTHS_M)
        heading_rad, phase_rad = random.uniform(0.0, 2.0 * math.pi, 2)
        wave_per_m = 2.0 * math.pi / length_m
        along_m = x_m * math.cos(heading_rad) + y_m * math.sin(heading_rad)
        # Each wave brings the same share of the squared slope; a sine's mean square is one half.
        height_m += GRADE * math.sqrt(2.0 / WAVES) / wave_per_m * np.sin(wave_per_m * along_m + phase_rad)
    return height_m


def make(seed: int) -> Ground:
    """Puts the ground into the connected world, friction left to the wheels."""
    height_m = heights(seed)
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_HEIGHTFIELD,
        # Without it, wheels that skid sideways catch on edges between triangles and may stick there for good.
        flags=pybullet.GEOM_CONCAVE_INTERNAL_EDGE,
        meshScale=[CELL_M, CELL_M, 1.0],
        heightfieldData=height_m.ravel().tolist(),
        numHeightfieldRows=SIDE_CELLS,
        numHeightfieldColumns=SIDE_CELLS,
    )
    body = pybullet.createMultiBody(0, shape)
    # Bullet centres a heightfield between its lowest and highest point.
    middle_m = (height_m.min() + height_m.max()) / 2
    pybullet.resetBasePositionAndOrientation(body, [0.0, 0.0, middle_m], [0.0, 0.0, 0.0, 1.0])
    # Bullet multiplies the friction of both bodies: with 1 here, the wheels' holds.
    pybullet.changeDynamics(body, -1, lateralFriction=1.0, rollingFriction=0.0, spinningFriction=0.0)
    return Ground(body, height_m)
