"""A question to recordings of a fleet, from their files to the service's list of jobs."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.request

import pytest
from conftest import documents
from joulepath import fleet

pytestmark = pytest.mark.usefixtures("cluster")


@pytest.fixture
def mixed(logs, tmp_path):
    """The fleet's logs, a file that is none, one that is there twice, and one that is gone."""
    folder = tmp_path / "logs"
    shutil.copytree(logs, folder)
    (folder / "unit-1" / "2026-03-09.csv").write_text("t_s,v_left_mps\n0,0\n0,0\n")
    shutil.copy(folder / "unit-0" / "2026-03-02.csv", folder / "unit-2" / "2026-03-16.csv")
    return [str(folder), str(folder / "unit-2" / "gone.csv")]


def test_every_recording_is_done_failed_or_a_duplicate_and_a_second_run_computes_nothing(mixed, tmp_path):
    storage = tmp_path / "store"
    run = fleet.calibrate(mixed, storage=storage)
    states = {(one["unit"], one["path"].rpartition("/")[2]): one["state"] for one in run.outcomes}
    assert states == {
        ("unit-0", "2026-03-02.csv"): "done",
        ("unit-1", "2026-03-02.csv"): "done",
        ("unit-2", "2026-03-02.csv"): "done",
        ("unit-1", "2026-03-09.csv"): "failed",
        ("unit-2", "gone.csv"): "failed",
        ("unit-2", "2026-03-16.csv"): "duplicate",
    }
    assert "gone.csv: No such file or directory" in str(run)
    assert "(unit-1):" in str(run)
    reports = {file: file.stat().st_mtime_ns for file in (storage / "reports").iterdir()}
    # Two names of one content are two jobs; the run counts them once.
    assert len(reports) == 5
    again = fleet.calibrate(mixed, storage=storage)
    assert again.id == run.id and again.counts.reused == 5
    assert {file: file.stat().st_mtime_ns for file in (storage / "reports").iterdir()} == reports
    assert len(list((storage / "fleet" / "runs").iterdir())) == 1


def test_a_run_whose_driver_was_killed_is_taken_up_where_it_was(logs, tmp_path, cluster):
    storage = tmp_path / "store"
    words = [sys.executable, "-m", "joulepath.fleet", "calibrate", "--recording", logs, "--storage", storage, "--address", cluster.address]
    driver = subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end_s = time.monotonic() + 60.0
    while not list(storage.glob("reports/*.json")):
        assert driver.poll() is None or list(storage.glob("reports/*.json"))
        assert time.monotonic() < end_s
        time.sleep(0.02)
    driver.send_signal(signal.SIGKILL)
    driver.wait()
    run = fleet.calibrate(logs, storage=storage)
    assert (run.counts.done, run.counts.failed) == (3, 0)
    assert run.counts.reused >= 1
    assert len(list(storage.glob("reports/*.json"))) == 3


def test_a_recording_that_takes_too_long_is_named_as_failed_and_computed_by_the_next_run(logs, tmp_path):
    storage = tmp_path / "store"
    run = fleet.calibrate(f"{logs}/unit-0", storage=storage, ways=fleet.Ways(task_timeout_s=0.01))
    assert (run.counts.done, run.counts.failed) == (0, 1)
    assert "unit-0): it took longer than 0.01 s" in str(run)
    again = fleet.calibrate(f"{logs}/unit-0", storage=storage)
    assert (again.counts.done, again.counts.failed) == (1, 0)


def test_drives_are_compared_with_healthy_ones_of_their_own_unit(logs, tmp_path):
    suspect, healthy = f"{logs}/unit-0/2026-03-02.csv", fleet.Drive(f"{logs}/unit-1/2026-03-02.csv", "unit-0")
    storage = fleet.Storage(tmp_path / "store")
    run = fleet.diagnose([suspect, f"{logs}/unit-2"], healthy=[healthy], storage=storage)
    assert run.counts.done == 2
    assert run.notes == ["no healthy drives of unit-2: compared with the robot file alone"]
    with_healthy, without = (one["result"] for one in run.results(storage))
    assert "reference_coverage" in with_healthy and "reference_coverage" not in without


def test_the_service_shows_what_a_fleet_has_left_in_its_store(logs, tmp_path, joulepath):
    storage = tmp_path / "store"
    run = fleet.diagnose(f"{logs}/unit-0", storage=storage)
    [outcome] = run.outcomes
    serving = subprocess.Popen(
        [*joulepath, "serve", "--bind", "127.0.0.1:0", "--store", str(storage)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        address = next(word for line in serving.stdout for word in line.replace('"', " ").split() if word.startswith("http://127.0.0.1:"))
        with urllib.request.urlopen(f"{address.rstrip('/,')}/v1/jobs/{outcome['job_id']}", timeout=20) as answer:
            job = json.load(answer)
        assert (job["kind"], job["state"]) == ("diagnose", "done")
        assert job["result"] == documents(storage / "reports")[f"{outcome['job_id']}.json"]["job"]["result"]
    finally:
        serving.terminate()
        serving.wait(timeout=20)


def test_a_matrix_in_blocks_is_the_matrix_and_a_block_that_fails_is_named(tmp_path, joulepath):
    level = [[0.0] * 30 for _ in range(20)]
    yard = tmp_path / "level.json"
    yard.write_text(json.dumps({"cell_size_m": 1.0, "rows": 20, "columns": 30, "elevation_m": level}))
    places = [(4.5, 8.5), (20.5, 12.5), (8.5, 4.5)]
    found = fleet.matrix(yard, places, storage=tmp_path / "store", block_sources=2)
    words = [*joulepath, "matrix", "--map", str(yard), "--json"]
    whole = subprocess.run([*words, *(f"--source={x},{y}" for x, y in places)], capture_output=True, text=True, check=True)
    assert found.energy_j.tolist() == json.loads(whole.stdout)["energy_j"]
    found = fleet.matrix(yard, [*places, (99.0, 99.0)], places, storage=tmp_path / "store", block_sources=1)
    assert [one["sources"] for one in found.failed] == [[3]]
    assert "99" in found.failed[0]["reason"]
    assert found.to_dict()["energy_j"][3] == [None] * 3


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["calibrate", "--recording", "nowhere/*.csv", "--storage", "store"], "holds no recording"),
        (["calibrate", "--storage", "store"], "there is no recording to ask about"),
        (["report", "--storage", "store"], "holds no run"),
        (["diagnose", "--recording", "a/b.csv", "--storage", "gs://x", "--robot", "husky-a200"], "give a folder or s3://BUCKET/PREFIX"),
        (["calibrate", "--recording", "a/b.csv", "--storage", "store", "--robot", "none.json"], "none.json is neither a built-in robot"),
        (["example", "--out", "x", "--weeks", "1"], "4 or more weeks"),
    ],
)
def test_a_command_that_is_wrong_ends_with_2_and_a_line_with_the_mend(words, says, tmp_path):
    done = subprocess.run([sys.executable, "-m", "joulepath.fleet", *words], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("python", "says"),
    [
        (sys.executable, "holds no run: run `fleet calibrate` or `fleet diagnose` first"),
        ("no-such-python", "install Python 3.10 or later, or let JOULEPATH_PYTHON name it"),
    ],
)
def test_the_command_goes_on_as_the_package_or_says_what_it_needs(joulepath, python, says, tmp_path):
    words = [*joulepath, "fleet", "report", "--storage", str(tmp_path / "store")]
    done = subprocess.run(words, capture_output=True, text=True, env={**os.environ, "JOULEPATH_PYTHON": python})
    assert done.returncode == 2
    assert says in done.stderr
