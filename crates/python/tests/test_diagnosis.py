"""Drives against a robot: by the same functions as the command line."""

from __future__ import annotations

import json

import numpy
import pytest

import joulepath


def test_a_model_predicts_its_own_power_to_the_noise(drive):
    found = joulepath.predict(drive, "husky-a200")
    assert found.total["rows"] == 1200 and abs(found.total["bias_w"]) < 3.0
    columns = found.columns
    error_w = columns["predicted_w"] - columns["recorded_w"]
    assert numpy.sqrt(numpy.mean(error_w**2)) == pytest.approx(found.total["rmse_w"], rel=0.02)
    assert "<html" in found.html() and "<iframe" in found._repr_html_()


def test_an_array_and_its_file_are_predicted_alike(drive, tmp_path):
    import pandas

    path = tmp_path / "drive.csv"
    rounded = {name: column.round(6) for name, column in drive.items()}
    pandas.DataFrame(rounded).to_csv(path, index=False)
    assert joulepath.predict(path).to_dict() == joulepath.predict(rounded).to_dict()
    assert joulepath.predict([path]).to_dict()["total"] == joulepath.predict(rounded).total


def test_a_payload_is_found_and_its_robot_predicts_better(simulated, tmp_path):
    steps = []
    found = joulepath.diagnose(simulated.recording, progress=lambda step, share: steps.append(share))
    named = {finding["mechanism"] for finding in found.findings}
    for explanation in found.to_dict().get("explanations", []):
        named |= set(explanation["mechanisms"])
    assert "payload" in named, found
    assert found.corrected["held_out_rmse_w"] < found.baseline["held_out_rmse_w"]
    assert steps == sorted(steps) and steps[0] == 0.0 and len(steps) > 3
    assert found.to_dict()["robot"] == found.corrected_robot.to_dict()
    assert found.trace["t_s"].shape == found.trace["recorded_w"].shape
    found.save(tmp_path / "out")
    assert json.loads((tmp_path / "out/report.json").read_text())["verdict"] == found.verdict
    assert joulepath.Robot.open(tmp_path / "out/corrected-robot.json") == found.corrected_robot


def test_a_calibration_gives_a_robot(simulated):
    found = joulepath.calibrate(simulated.recording, despite=["held_out"])
    assert found.robot.mass_kg > 0 and found.parameters


def test_a_simulation_is_its_file(simulated, tmp_path):
    simulated.save(tmp_path / "drive.csv")
    again = joulepath.Recording.open(tmp_path / "drive.csv")
    assert again.rows == simulated.recording.rows
    numpy.testing.assert_array_equal(again["t_s"], simulated.recording["t_s"])
    assert simulated.key["truths"][0]["effect"] == "payload"
