"""A report over a storage with made-up results."""

import datetime
import json
from html.parser import HTMLParser

import numpy as np
import pytest
from joulepath import fleet
from joulepath.fleet.run import Run

FIRST = datetime.date(2026, 3, 2)


def outcome(unit, week, state="done", problem=None):
    date = (FIRST + datetime.timedelta(weeks=week)).isoformat()
    id = f"{unit}{week:02d}".encode().hex().ljust(32, "0")
    return {
        "path": f"logs/{unit}/{date}.csv",
        "unit": unit,
        "date": date,
        "state": state,
        "recording_id": id,
        "job_id": id,
        "reused": False,
        "problem": problem,
        "spent_s": 1.0,
    }


def calibrated(value, sigma):
    interval = [value - 1.96 * sigma, value + 1.96 * sigma]
    return {
        "parameters": [
            {"name": "surfaces.marble.mu_roll", "value": value, "unit": "1", "interval_95": interval, "determined": True},
            {"name": "hotel_power_w", "value": 0.0, "unit": "W", "interval_95": [0.0, 600.0], "determined": False},
        ]
    }


@pytest.fixture
def storage(tmp_path):
    """Twelve units over six weeks; unit <b>u3</b>, whose name is hostile, rolls 20 % harder from the fourth week on, and one recording failed."""
    random = np.random.default_rng(5)
    storage = fleet.Storage(tmp_path)
    outcomes = []
    for i in range(12):
        unit = "<b>u3</b>" if i == 3 else f"u{i}"
        own = random.normal(0.0, 0.1)
        for week in range(6):
            ill = 0.2 if i == 3 and week >= 3 else 0.0
            one = outcome(unit, week)
            value = 0.06 * np.exp(own + ill + random.normal(0.0, 0.01))
            storage.write(storage.report_name(one["job_id"]), {"job": {"result": calibrated(value, 0.01 * value)}})
            outcomes.append(one)
    outcomes.append(outcome("u5", 7, "failed", {"detail": "the file ends in line 7"}))
    run = Run("0f", "calibrate", outcomes, [])
    storage.write("fleet/runs/0f.json", {"written": "2026-05-01", **run.to_dict()})
    return storage


def test_it_names_the_unit_the_parameter_the_size_and_the_day(storage):
    found = fleet.report(storage)
    assert found.named == ["<b>u3</b>"]
    [named] = found.to_dict()["named"]
    assert named["since"] == "2026-03-23"
    foremost = named["departures"][0]
    assert (foremost["parameter"], foremost["kind"]) == ("surfaces.marble.mu_roll", "step")
    low, high = foremost["interval_95"]
    assert low < np.expm1(0.2) < high
    assert "surfaces.marble.mu_roll changed by +2" in named["sentence"]


def test_what_a_recording_does_not_determine_is_no_figure_of_the_fleet(storage):
    assert [one["parameter"] for one in fleet.report(storage).to_dict()["parameters"]] == ["surfaces.marble.mu_roll"]


def test_failed_recordings_stand_in_it_by_name_and_number(storage):
    document = fleet.report(storage).to_dict()
    assert [(one["path"], one["problem"]["detail"]) for one in document["left_out"]] == [("logs/u5/2026-04-20.csv", "the file ends in line 7")]
    [u5] = [one for one in document["units"] if one["unit"] == "u5"]
    assert (u5["drives"], u5["left_out"]) == (6, 1)


def test_a_drive_of_two_runs_counts_once(storage):
    document = storage.read("fleet/runs/0f.json")
    storage.write("fleet/runs/1e.json", {**document, "id": "1e", "written": "2026-05-02"})
    [figures] = fleet.report(storage).to_dict()["parameters"]
    assert figures["drives"] == 11 * 6


def test_it_is_written_as_document_tables_and_one_page_that_asks_nobody(storage, tmp_path):
    fleet.report(storage).write(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "report.json").read_text())["named"]
    assert (tmp_path / "out" / "units.csv").read_text().count("\n") == 13
    page = (tmp_path / "out" / "report.html").read_text()
    tags, names = [], []

    class Tags(HTMLParser):
        def handle_starttag(self, tag, attributes):
            tags.append(tag)
            names.extend(name for name, _ in attributes)

    Tags().feed(page)
    assert "polyline" in tags
    assert not {"script", "img", "link", "iframe", "b"} & set(tags)
    assert not {"src", "href", "onload"} & set(names)


def test_a_report_that_is_gone_from_the_storage_is_said_with_the_mend(storage, tmp_path):
    next(iter((tmp_path / "reports").iterdir())).unlink()
    with pytest.raises(fleet.FleetError, match="no longer in the storage; ask for the run again"):
        fleet.report(storage)


def test_a_storage_without_runs_and_a_rate_that_is_none_are_refused(storage, tmp_path):
    with pytest.raises(fleet.FleetError, match="holds no run"):
        fleet.report(tmp_path / "empty")
    with pytest.raises(fleet.FleetError, match="give a chance between 0 and 0.5"):
        fleet.report(storage, false_alarm_rate=1.0)
