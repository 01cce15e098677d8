"""PySINDy on the cases of a trial: which terms does it say are missing, and in how many drives in which nothing is?

A library of products of what drives the robot is fitted to the healthy drives, and what that leaves of the drives under suspicion is put
to PySINDy's sequentially thresholded least squares (Kaheman et al., "Learning discrepancy models from experimental data", 2019). How much
a term has to be worth to be kept is what tells fifths of the drives best that were not fitted, and to keep none is among the choices.
"""

import csv
import json
import math
import sys
import warnings
from pathlib import Path

import numpy as np
import pysindy as ps

WORTHS = [0.01, 0.02, 0.05, 0.1, 0.2, math.inf]
"""Shares of the mean power that a term may have to be worth."""
FOLDS = 5
"""Parts of the drives that are left out in turn."""
AVERAGE_S = 1.0
"""Time over which rows are averaged."""
LEAST_MPS = 0.02
"""Rim speed below which a robot stands still, where terms tell nothing."""
SIDES = ("left", "right")


def averages(path):
    """Inputs and powers of both sides, second by second."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))

    def column(name):
        return np.array([float(row[name]) if row[name] else math.nan for row in rows])

    t_s = column("t_s")
    runs = np.unique([row["run"] for row in rows], return_inverse=True)[1]
    keys = runs * 10**7 + np.floor(t_s / AVERAGE_S).astype(int)
    group = np.unique(keys, return_inverse=True)[1]

    def mean(values):
        known = np.isfinite(values)
        count = np.bincount(group[known], minlength=group.max() + 1)
        total = np.bincount(group[known], values[known], minlength=group.max() + 1)
        with np.errstate(invalid="ignore"):
            return total / np.where(count > 0, count, math.nan)

    left, right = mean(column("v_left_mps")), mean(column("v_right_mps"))
    speed = (left + right) / 2
    accel = np.gradient(speed, AVERAGE_S)
    pitch, roll = np.sin(mean(column("pitch_rad"))), np.sin(mean(column("roll_rad")))
    sides = {}
    for side, rim in zip(SIDES, (left, right)):
        inputs = np.column_stack([rim, np.abs(rim), right - left, np.abs(right - left), pitch, roll, accel])
        power = mean(column(f"power_{side}_w"))
        counts = np.isfinite(inputs).all(axis=1) & np.isfinite(power) & (np.abs(rim) > LEAST_MPS)
        sides[side] = inputs[counts], power[counts]
    return sides


NAMES = ["u", "|u|", "d", "|d|", "sin_pitch", "sin_roll", "a"]


def fitted(inputs, power, worth):
    """PySINDy's model of a power, of terms that are worth so much of it."""
    # Of columns of length 1 a weight is the root of the sum of squares that it stands for.
    threshold = worth * math.sqrt(len(power))
    optimizer = ps.STLSQ(threshold=threshold, alpha=1e-2, normalize_columns=True)
    model = ps.SINDy(optimizer=optimizer, feature_library=ps.PolynomialLibrary(degree=2))
    with warnings.catch_warnings():
        # It warns where it keeps no term, which is an answer.
        warnings.simplefilter("ignore")
        model.fit(inputs, t=AVERAGE_S, x_dot=power[:, None], feature_names=NAMES)
    return model


def predicted(model, inputs):
    return np.asarray(model.predict(inputs)).ravel()


def held_out(inputs, power, worth):
    """Sum of squares of what each part of the drives is off by under a model of the others."""
    if math.isinf(worth):
        return np.sum(power**2)
    part = np.arange(len(power)) * FOLDS // len(power)
    total = 0.0
    for out in range(FOLDS):
        model = fitted(inputs[part != out], power[part != out], worth)
        total += np.sum((power[part == out] - predicted(model, inputs[part == out])) ** 2)
    return total


def missing(folder):
    """Terms that PySINDy finds missing in a case, both sides together."""
    suspect, healthy = (averages(folder / name) for name in ("recording.csv", "reference.csv"))
    terms = []
    for side in SIDES:
        inputs, power = healthy[side]
        scale = np.sqrt(np.mean(inputs**2, axis=0))
        scale[scale == 0.0] = 1.0
        as_usual = fitted(inputs / scale, power, 0.0)
        inputs, power = suspect[side]
        inputs = inputs / scale
        left = power - predicted(as_usual, inputs)
        worths = [share * np.mean(np.abs(power)) for share in WORTHS]
        worth = min(worths, key=lambda worth: held_out(inputs, left, worth))
        if math.isfinite(worth):
            model = fitted(inputs, left, worth)
            kept = zip(model.get_feature_names(), model.coefficients().ravel())
            terms += [f"{name} ({side})" for name, weight in kept if weight != 0.0]
    return terms


def main():
    proof = Path(sys.argv[1])
    scores = json.loads((proof / "scoreboard.json").read_text())["scores"]
    counts = {}

    def count(kind, terms):
        hits, of, most = counts.get(kind, (0, 0, []))
        counts[kind] = (hits + bool(terms), of + 1, most + [len(terms)])

    for score in scores:
        kind = {"healthy": "healthy drives", "decoy": "decoys", "unlisted": "outside the list"}.get(score["kind"], "effects of the list")
        count(kind, missing(proof / "cases" / score["case"]))
        if score["twin"] is not None:
            count("effects taken away", missing(proof / "twins" / score["case"]))
    for kind in ("healthy drives", "decoys", "effects taken away", "effects of the list", "outside the list"):
        if kind in counts:
            hits, of, most = counts[kind]
            print(f"{kind}: something missing in {hits} of {of}, {np.median(most):.0f} terms in the median")


main()
