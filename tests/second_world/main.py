"""Drives all cases, has them diagnosed, and prints how well that went.

A second world beside joulepath's own: bodies, contacts, ground and wheel motors are Bullet's, motors' power, rolling resistance,
effects and sensors are these files', and no line of joulepath's is in it. What joulepath sees of a case is the robot file that it
calibrated itself, the recording, and recordings of healthy drives over other ground.
"""

import argparse
import dataclasses
import functools
import shutil
import sys
from pathlib import Path

import pybullet

import cases
import joulepath
import score as scores
import sensors
from drive import Trip, connect, drive
from effects import Effects
from husky import Husky

# Courses of a seed; those of suspects are numbered from 1.
REFERENCE_COURSE, CALIBRATION_COURSE = 50, 60


def measures() -> dict:
    """What the robot's own file says of its body."""
    connect()
    try:
        return Husky([0.0, 0.0, 0.0], 0.0).measures()
    finally:
        pybullet.disconnect()


class Proof:
    """All drives of a seed and what is written about them."""

    def __init__(self, seed: int, lengths: cases.Lengths, out: Path) -> None:
        self.seed, self.lengths, self.out = seed, lengths, out
        self.measures = measures()
        self.driven = functools.cache(drive)

    def trip(self, course: int, duration_s: float, effects: Effects = Effects()) -> Trip:
        """A drive over a course of this seed. What only a sensor does differently is the same drive."""
        return Trip(1000 * self.seed + course, duration_s, dataclasses.replace(effects, pitch_bias_rad=0.0))

    def recorded(self, trips: list[Trip], noise: int, name: str, pitch_bias_rad: float = 0.0) -> Path:
        """A recording of drives, each a run."""
        runs = [sensors.record(self.driven(trip), 1000 * self.seed + noise, run + 1, pitch_bias_rad)
                for run, trip in enumerate(trips)]
        path = self.out / f"{name.replace(' ', '-')}.csv"
        sensors.write(runs, path)
        return path

    def healthy(self) -> tuple[Path, list[Path]]:
        """The calibrated robot and reference drives."""
        courses = range(CALIBRATION_COURSE, CALIBRATION_COURSE + self.lengths.calibration_runs)
        drives = [self.trip(course, self.lengths.calibration_s) for course in courses]
        recording = self.recorded(drives, CALIBRATION_COURSE, "calibration")
        robot = self.out / "robot.json"
        joulepath.calibrate(self.measures, recording, robot)
        courses = range(REFERENCE_COURSE, REFERENCE_COURSE + self.lengths.references)
        references = [
            self.recorded([self.trip(course, self.lengths.reference_s)], course, f"reference {course}") for course in courses
        ]
        total = joulepath.predict(robot, references)
        missing = 1.0 - total["predicted_j"] / total["recorded_j"]
        print(f"calibrated robot on the reference drives: RMSE {total['rmse_w']:.1f} W, R2 {total['r2']:.2f}, "
              f"{100 * missing:.1f} % of the energy not predicted\n", flush=True)
        return robot, references

    def scored(self, number: int, case: cases.Case, robot: Path, references: list[Path]) -> scores.Score:
        """Conceals, diagnoses, and opens what was concealed."""
        trip = self.trip(case.course, self.lengths.suspect_s, case.effects)
        twin = self.trip(case.course, self.lengths.suspect_s)
        recording = self.recorded([trip], 100 + number, case.name, case.effects.pitch_bias_rad)
        report = joulepath.diagnose(robot, recording, references, recording.with_suffix(""))
        share = scores.share(
            self.driven(trip), self.driven(twin), case.effects.pitch_bias_rad, self.measures["mass_kg"]
        )
        return scores.score(case, share, report, float(self.driven(trip)["heading_rad"][0]))


def main() -> int:
    """Runs what the arguments ask for; the exit status tells whether what is claimed held."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", choices=["all", "short"], default="all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder for recordings and reports; it is made anew")
    options = parser.parse_args()
    out = options.out.resolve()
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    chosen, lengths = (cases.ALL, cases.FULL) if options.cases == "all" else (cases.SHORT, cases.BRIEF)
    proof = Proof(options.seed, lengths, out)
    robot, references = proof.healthy()
    found = []
    for number, case in enumerate(chosen):
        found.append(proof.scored(number, case, robot, references))
        print(f"{case.name}: {found[-1].verdict}", file=sys.stderr, flush=True)
    text = f"{scores.table(found)}\n\n{scores.totals(found)}"
    (out / "scores.txt").write_text(text + "\n")
    print(text)
    if options.cases == "all":
        return 0
    return int(any(s.detected for s in found if s.case.truth is None))


if __name__ == "__main__":
    sys.exit(main())
