"""What a report says, held against what was concealed."""

import math
from dataclasses import dataclass

import numpy as np

from cases import Case
from effects import push_n
from husky import GRAVITY_MPS2
from sensors import Truth, side_power_w

# Bullet's wheels stick and slip in turns, a little otherwise in every drive: shares are taken from means over this time.
WINDOW_ROWS = 50
# Names in a finding's set up to which it counts as an answer, as in joulepath's own trial.
LARGEST_ANSWER = 2
# Totals by share of the mean power.
BANDS = (("effects below 10 %", 0.0, 0.10), ("effects of 10 % and more", 0.10, float("inf")))


@dataclass(frozen=True)
class Score:
    """One line of the table."""

    case: Case
    share: float
    verdict: str
    sets: list[list[str]]
    estimates: str
    before_w: float
    after_w: float

    @property
    def detected(self) -> bool:
        """Whether the report finds anything missing."""
        return self.verdict != "consistent"

    @property
    def named(self) -> bool:
        """Whether the truth is in a set that is small enough to act upon."""
        return any(self.case.truth in names and len(names) <= LARGEST_ANSWER for names in self.sets)


def _means(power_w: np.ndarray) -> np.ndarray:
    whole = len(power_w) // WINDOW_ROWS * WINDOW_ROWS
    return power_w[:whole].reshape(-1, WINDOW_ROWS).mean(axis=1)


def share(truth: Truth, twin: Truth, pitch_bias_rad: float, mass_kg: float) -> float:
    """Root mean square change of power over the mean power of the same drive without the effect.

    A sensor's fault changes no power: its share is that of the power that the slope it feigns would take.
    """
    plain_w = side_power_w(twin).sum(axis=0)
    if pitch_bias_rad != 0.0:
        slope_n = mass_kg * GRAVITY_MPS2 * pitch_bias_rad / 2
        feigned = twin | {name: twin[name] + slope_n for name in ("force_left_n", "force_right_n")}
        change_w = side_power_w(feigned).sum(axis=0) - plain_w
    else:
        change_w = side_power_w(truth).sum(axis=0) - plain_w
    return float(np.sqrt(np.mean(_means(change_w) ** 2)) / plain_w.mean())


def _in_the_world(mechanism: str, found: dict[str, float], start_heading_rad: float) -> dict[str, float]:
    """Parameters in a form that can be held against the truth.

    Power tells the force of a wind, hardly its speed and the drag area by themselves. Recordings hold no heading here, and
    joulepath's east is then where the robot faced at the start.
    """
    if mechanism != "wind":
        return found
    east_mps, north_mps = found["east_mps"], found["north_mps"]
    towards_rad = math.remainder(math.atan2(north_mps, east_mps) + start_heading_rad, 2.0 * math.pi)
    return {"push_n": push_n(found["drag_area_m2"], east_mps, north_mps), "towards_rad": towards_rad}


def _estimates(case: Case, findings: list[dict], start_heading_rad: float) -> str:
    """Parameters of the finding that names the truth first, each beside what is true."""
    for finding in findings:
        if finding["mechanism"] == case.truth:
            given = {parameter["name"]: parameter["value"] for parameter in finding["parameters"]}
            found = _in_the_world(finding["mechanism"], given, start_heading_rad)
            return ", ".join(f"{name} {found[name]:.3g} ({true:.3g})" for name, true in case.parameters)
    return "-"


def score(case: Case, power_share: float, report: dict, start_heading_rad: float) -> Score:
    """Reads a report."""
    findings = report["findings"]
    sets = [list(dict.fromkeys([f["mechanism"], *f["indistinguishable_from"]])) for f in findings]
    before_w = report["baseline"]["held_out_rmse_w"]
    return Score(case, power_share, report["verdict"], sets, _estimates(case, findings, start_heading_rad), before_w,
                 report["corrected"]["held_out_rmse_w"])


def table(scores: list[Score]) -> str:
    """The scores as text."""
    head = ("case", "truth", "share", "verdict", "named", "before W", "after W", "estimate (truth)")
    lines = [head] + [
        (s.case.name, s.case.truth or "none", f"{100 * s.share:.1f} %", s.verdict,
         " + ".join("{" + ", ".join(names) + "}" for names in s.sets) or "-",
         f"{s.before_w:.2f}", f"{s.after_w:.2f}", s.estimates)
        for s in scores
    ]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def totals(scores: list[Score]) -> str:
    """Counts over all cases."""
    healthy = [s for s in scores if s.case.truth is None]
    lines = [f"false alarms: {sum(s.detected for s in healthy)} of {len(healthy)}"]
    for name, low, high in BANDS:
        band = [s for s in scores if s.case.truth is not None and low <= s.share < high]
        named, detected = sum(s.named for s in band), sum(s.detected for s in band)
        lines.append(f"{name}: {detected} of {len(band)} detected, {named} with the truth in a set of at most two")
    return "\n".join(lines)
