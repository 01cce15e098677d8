"""From the truth to a recording: what the motors draw, and what sensors make of it."""

from pathlib import Path

import numpy as np

from course import STEP_S

# A brushed gear motor on each side: copper loss by squared force, and gears that pass on a share of the work in either
# direction. Sizes near a Husky's equivalent constants (Dogru & Marques, T-RO 2018, Table I: 0.0023 and 0.0016 W/N2, 1.72 and
# 1.77 electrical per mechanical watt), but neither those nor the same on both sides, so that calibration has work to do.
COPPER_W_PER_N2 = np.array([0.0021, 0.0019])
EFFICIENCY = np.array([0.60, 0.61])

# One sigma each: shunts of 1 % with a watt of noise, encoders and a gyroscope of a field robot, an inclinometer of a tenth of
# a degree, satellite navigation with corrections.
POWER_NOISE_W, POWER_GAIN_NOISE = 1.0, 0.01
SPEED_NOISE_MPS = 0.002
YAW_RATE_NOISE_RADPS = 0.003
TILT_NOISE_RAD = 0.002
POSITION_NOISE_M = 0.02

Truth = dict[str, np.ndarray]


def side_power_w(truth: Truth) -> np.ndarray:
    """Power of both sides, from means over a row: what a motor's winding and gears leave of the chatter of Bullet's contacts."""
    powers = []
    for i, side in enumerate(("left", "right")):
        force_n, speed_mps = truth[f"force_{side}_n"], truth[f"v_{side}_mps"]
        work_w = force_n * speed_mps
        through_gears_w = np.where(work_w >= 0.0, work_w / EFFICIENCY[i], work_w * EFFICIENCY[i])
        powers.append(COPPER_W_PER_N2[i] * force_n**2 + through_gears_w)
    return np.array(powers)


def _over_row(at_end: np.ndarray) -> np.ndarray:
    """Means over rows of what is known at their ends."""
    return (np.concatenate([at_end[:1], at_end[:-1]]) + at_end) / 2


def record(truth: Truth, seed: int, run: int, pitch_bias_rad: float = 0.0) -> Truth:
    """Columns of a recording, by joulepath's names."""
    random = np.random.default_rng([seed, run, 3])
    rows = len(truth["x_m"])

    def noise(sigma: float) -> np.ndarray:
        return sigma * random.standard_normal(rows)

    power_w = side_power_w(truth)
    recording = {"t_s": np.arange(1, rows + 1) * STEP_S}
    recording |= {name: truth[name] + noise(SPEED_NOISE_MPS) for name in ("v_left_mps", "v_right_mps")}
    for i, side in enumerate(("left", "right")):
        recording[f"power_{side}_w"] = power_w[i] * (1.0 + noise(POWER_GAIN_NOISE)) + noise(POWER_NOISE_W)
    recording["yaw_rate_radps"] = truth["yaw_rate_radps"] + noise(YAW_RATE_NOISE_RADPS)
    recording["pitch_rad"] = _over_row(truth["pitch_rad"]) + pitch_bias_rad + noise(TILT_NOISE_RAD)
    recording["roll_rad"] = _over_row(truth["roll_rad"]) + noise(TILT_NOISE_RAD)
    recording |= {name: truth[name] + noise(POSITION_NOISE_M) for name in ("x_m", "y_m", "z_m")}
    recording["run"] = np.full(rows, run)
    return recording


def write(runs: list[Truth], path: Path) -> None:
    """Writes runs one below the other as comma-separated text."""
    names = list(runs[0])
    table = np.concatenate([np.array([run[name] for name in names]).T for run in runs])
    digits = ["%d" if name == "run" else "%.3f" if name.endswith("_w") else "%.6f" for name in names]
    np.savetxt(path, table, fmt=digits, delimiter=",", header=",".join(names), comments="")
