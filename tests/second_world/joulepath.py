"""The program under test, as a process that sees files alone."""

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

# What a robot file must say and Bullet's does not: a Husky's motors (Dogru & Marques, T-RO 2018, Table I) and its friction on
# marble (Table II). Only the slip angle is another: Bullet's wheels skid by Coulomb's law from the smallest angle, and the
# 0.30 rad of rubber are not theirs.
BASE = {
    "name": "pybullet-husky",
    "max_wheel_speed_mps": 1.0,
    "motors": {
        "left": {"k1_w_per_n2": 0.0023, "k2": 1.7158},
        "right": {"k1_w_per_n2": 0.0016, "k2": 1.7723},
        "regeneration": 1.0,
    },
    "surfaces": {"hills": {"mu_roll": 0.063, "mu_skid": 0.29, "slip_angle_scale_rad": 0.05}},
    "default_surface": "hills",
}


def _run(arguments: list[str], room: Path) -> str:
    """What the program prints, which is to succeed."""
    program = os.environ["JOULEPATH"]
    done = subprocess.run([program, *arguments], cwd=room, env={}, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"joulepath {arguments[0]} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def calibrate(measures: dict, recording: Path, out: Path) -> None:
    """Fits the base robot with a body's measures to a healthy recording."""
    base = out.with_name("base-robot.json")
    base.write_text(json.dumps(BASE | measures, indent=2))
    _run(["calibrate", "--robot", str(base), "--recording", str(recording), "--out", str(out)], out.parent)


def predict(robot: Path, recordings: list[Path]) -> dict:
    """How far the robot's predictions are off, over all recordings."""
    given = [word for recording in recordings for word in ("--recording", str(recording))]
    return json.loads(_run(["predict", "--robot", str(robot), *given, "--json"], robot.parent))["total"]


def diagnose(robot: Path, recording: Path, references: list[Path], keep: Path) -> dict:
    """The report on a recording, made in a room of its own that holds copies of its files and nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        room = Path(folder)
        shutil.copy(robot, room / "robot.json")
        shutil.copy(recording, room / "recording.csv")
        arguments = ["diagnose", "--robot", "robot.json", "--recording", "recording.csv", "--out", "result"]
        for i, reference in enumerate(references):
            shutil.copy(reference, room / f"reference-{i}.csv")
            arguments += ["--reference", f"reference-{i}.csv"]
        _run(arguments, room)
        shutil.copytree(room / "result", keep, dirs_exist_ok=True)
        return json.loads((room / "result" / "report.json").read_text())
