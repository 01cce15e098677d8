"""An example fleet: robots of the independent simulator, some of which fall ill in a known week.

The recordings lie as a fleet's logs do, one folder per unit and one file per drive, named after its date. What is wrong with which unit
stands in `truth.json` beside them, which no other part of the package reads.
"""

from __future__ import annotations

import datetime
import json
import os
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import joulepath

from .errors import FleetError

FIRST_DAY = datetime.date(2026, 3, 2)
"""Date of the first drives. A Monday, so that a week is a row of the report."""

EFFECTS: dict[str, tuple[float, float]] = {
    "drivetrain_drag": (12.0, 25.0),
    "hotel_load": (12.0, 30.0),
    "payload": (15.0, 30.0),
    "wheel_radius": (0.05, 0.12),
    "power_scale": (0.08, 0.2),
}
"""What ill units suffer from, with the range of its strength in the unit of `joulepath schema world`.

The ranges are the upper halves of what the simulator's own catalogue gives for a Husky: an illness, not a nuance.
"""


@dataclass(frozen=True)
class Scale:
    """Size of an example fleet."""

    units: int = 20
    """Number of robots, at least 2."""
    ill: int = 3
    """How many of them fall ill."""
    weeks: int = 8
    """Number of weekly drives of each robot, at least 4, so that there is a before and an after."""
    duration_s: float = 600.0
    """Length of a drive [s]."""

    def check(self) -> None:
        """Refuses sizes of which no fleet can be made."""
        if self.units < 2 or not 0 <= self.ill <= min(self.units, len(EFFECTS)) or self.weeks < 4 or not self.duration_s >= 60.0:
            raise FleetError(
                "invalid-request",
                f"an example fleet needs 2 or more units, 0 to {len(EFFECTS)} ill ones among them, 4 or more weeks and drives of 60 s or "
                f"more, not {self.units} units, {self.ill} ill, {self.weeks} weeks and {self.duration_s} s",
            )


def simulate_fleet(
    folder: str | os.PathLike[str],
    scale: Scale = Scale(),
    *,
    seed: int = 1,
    robot: str = "husky-a200",
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Path:
    """Simulates a fleet into `folder/UNIT/DATE.csv` and writes what is wrong with it to `folder/truth.json`.

    Every robot keeps the scatter of its constants from week to week (one standard deviation of the robot file's `uncertainty`); ground, drive
    and sensor noise differ from drive to drive. Recordings that are there already are kept. Returns the folder.
    """
    scale.check()
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    draw = random.Random(seed)
    units = [f"unit-{number:02d}" for number in range(1, scale.units + 1)]
    robot_seeds = {unit: draw.randrange(2**48) for unit in units}
    truth: list[dict[str, Any]] = []
    for unit, effect in zip(draw.sample(units, scale.ill), draw.sample(sorted(EFFECTS), scale.ill), strict=True):
        strength = round(draw.uniform(*EFFECTS[effect]), 3)
        week = draw.randrange(2, scale.weeks - 1)
        since = FIRST_DAY + datetime.timedelta(weeks=week)
        truth.append({"unit": unit, "effect": effect, "strength": strength, "week": week, "since": since.isoformat()})
    (folder / "truth.json").write_text(json.dumps({"seed": seed, "ill": truth}, indent=2))
    ill = {one["unit"]: one for one in truth}
    for i, unit in enumerate(units):
        for week in range(scale.weeks):
            world_seed, drive_seed, ground_seed = (draw.randrange(2**48) for _ in range(3))
            world = {
                "terrain": {"rolling": {"grade": 0.05, "seed": ground_seed}},
                "scatter": 1.0,
                "seed": world_seed,
                "robot_seed": robot_seeds[unit],
                "effects": [
                    {"effect": one["effect"], "strength": one["strength"]}
                    for one in [ill.get(unit)]
                    if one is not None and week >= one["week"]
                ],
            }
            drive = {"kind": "rich", "duration_s": scale.duration_s, "seed": drive_seed}
            date = FIRST_DAY + datetime.timedelta(weeks=week)
            simulate_drive(folder / unit / f"{date.isoformat()}.csv", robot, world, drive)
            progress(i * scale.weeks + week + 1, len(units) * scale.weeks)
    return folder


def simulate_drive(recording: Path, robot: str, world: dict[str, Any], drive: dict[str, Any]) -> None:
    """Simulates one drive, unless it is there."""
    if recording.exists():
        return
    recording.parent.mkdir(parents=True, exist_ok=True)
    beside = recording.with_name(f".{recording.name}.part")
    joulepath.simulate(world, drive, robot).save(beside)
    beside.replace(recording)
