"""The command that comes with the package."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import joulepath

MAPS = Path(os.environ["JOULEPATH_MAPS"])
SCRIPT = Path(sys.executable).with_name("joulepath")
ENVIRONMENT = {name: value for name, value in os.environ.items() if name not in ("JOULEPATH", "JOULEPATH_PYTHON")}


def said(*words: object, program: tuple[str, ...] = (str(SCRIPT),), cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    line = [*program, *map(str, words)]
    return subprocess.run(line, capture_output=True, text=True, check=False, env=ENVIRONMENT, cwd=cwd)


@pytest.mark.parametrize("program", [(str(SCRIPT),), (sys.executable, "-m", "joulepath")])
def test_it_is_there_by_its_name_and_as_a_module(program):
    version = said("--version", program=program)
    assert version.returncode == 0 and version.stdout.startswith("joulepath 0.1.0")
    assert "Usage: joulepath <COMMAND>" in said("--help", program=program).stdout


def test_it_plans_what_the_package_plans(tmp_path):
    out = tmp_path / "path.json"
    told = said("plan", "--map", MAPS / "minnesota.tif", "--start", "429300,5150560", "--goal", "429600,5150800", "--robot", "husky-a200", "--out", out)
    assert told.returncode == 0, told.stderr
    start, goal = (429300, 5150560), (429600, 5150800)
    path = joulepath.Planner(joulepath.Map.open(MAPS / "minnesota.tif"), "husky-a200").plan(start, goal)
    assert json.loads(out.read_text())["energy_j"] == pytest.approx(path.energy_j, rel=1e-12)


def test_its_exit_statuses_are_the_commands(tmp_path):
    for words, status in [(("plan", "--nothing"), 2), (("robot", "show", "no-such-robot"), 2), (("predict",), 2)]:
        told = said(*words)
        assert told.returncode == status, told.stderr
        assert told.stdout == "" and told.stderr


def test_what_starts_a_server_is_said_to_be_elsewhere():
    for words in [("serve", "--help"), ("open", "map.tif"), ("demo",)]:
        told = said(*words)
        assert told.returncode == 2 and "has no server" in told.stderr and told.stderr.count("\n") == 1


def test_a_trial_calls_the_package_again(tmp_path):
    told = said("prove", "--cases", 1, "--way", "file-alone", "--seed", 3, "--out", tmp_path / "trial")
    assert told.returncode == 0, told.stderr
    boards = list((tmp_path / "trial").rglob("scoreboard.json"))
    assert boards and all("it did not start" not in board.read_text() for board in boards)


def test_ctrl_c_ends_it(tmp_path):
    words = [str(SCRIPT), "prove", "--cases", "2", "--out", str(tmp_path / "trial")]
    # Whoever runs the tests in the background may have it ignored.
    heard = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    running = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, preexec_fn=heard)
    # Keys are committed to once all cases are drawn, and before any is diagnosed.
    assert running.stdout is not None and "committed" in running.stdout.readline()
    running.send_signal(signal.SIGINT)
    _, complaint = running.communicate(timeout=60)
    assert running.returncode == 130 and "interrupted" in complaint


def test_fleets_are_asked_in_the_same_interpreter():
    told = said("fleet", "--help")
    assert told.returncode == 0 and "diagnose" in told.stdout
    assert shutil.which("joulepath", path=str(SCRIPT.parent)) == str(SCRIPT)
