"""What can be concealed, each with its strength in its own units."""

import math
from dataclasses import dataclass

# Standard atmosphere at sea level and 15 degrees (ISO 2533) [kg/m3].
AIR_KG_PER_M3 = 1.225
# A Husky is 0.67 m wide and 0.39 m high; a bluff box has a drag coefficient of about 1 (Hoerner, Fluid-Dynamic Drag, 1965).
DRAG_AREA_M2 = 0.67 * 0.39
# Rim speed over which a dry friction takes its full size [m/s].
CREEP_MPS = 0.02


def push_n(drag_area_m2: float, east_mps: float, north_mps: float) -> float:
    """Force of the air on what stands in it."""
    return 0.5 * AIR_KG_PER_M3 * drag_area_m2 * (east_mps**2 + north_mps**2)


@dataclass(frozen=True)
class Effects:
    """Everything that differs from the healthy robot; zero is healthy."""

    payload_kg: float = 0.0
    wind_east_mps: float = 0.0
    wind_north_mps: float = 0.0
    drag_left_n: float = 0.0
    drag_right_n: float = 0.0
    roll_change: float = 0.0
    skid_change: float = 0.0
    pitch_bias_rad: float = 0.0

    def wind_n(self, velocity_mps: tuple[float, float]) -> tuple[float, float]:
        """Force of the wind, east and north; still air is taken to be part of the healthy robot's rolling resistance."""
        if self.wind_east_mps == 0.0 and self.wind_north_mps == 0.0:
            return 0.0, 0.0
        east_mps = self.wind_east_mps - velocity_mps[0]
        north_mps = self.wind_north_mps - velocity_mps[1]
        factor = 0.5 * AIR_KG_PER_M3 * DRAG_AREA_M2 * math.hypot(east_mps, north_mps)
        return factor * east_mps, factor * north_mps

    def other_ground(self, x_m: float) -> bool:
        """Whether the ground is another here: the eastern half is, where it changes at all."""
        return x_m > 0.0 and (self.roll_change != 0.0 or self.skid_change != 0.0)
