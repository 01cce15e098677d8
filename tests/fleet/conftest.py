"""Two Ray nodes on the loopback, each with one core, and a few recordings."""

import importlib.util
import json

import pytest
from nodes import Cluster


@pytest.fixture(scope="session")
def cluster():
    """A cluster to which the driver of these tests is connected."""
    # Ray reads the token's place from the environment when it is imported: the cluster is made before.
    if importlib.util.find_spec("ray") is None:
        pytest.skip("there is no Ray here")
    found = Cluster()
    try:
        found.connect()
        found.add()
        yield found
    finally:
        found.end()


@pytest.fixture(scope="session")
def joulepath():
    """The command, or a skip."""
    from joulepath.fleet import FleetError
    from joulepath.fleet.command import joulepath_command

    try:
        return joulepath_command()
    except FleetError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def logs(tmp_path_factory, joulepath):
    """Drives of three units, of 150 s each."""
    from joulepath.fleet.example import simulate_drive

    folder = tmp_path_factory.mktemp("logs")
    for i in range(3):
        world = {"terrain": {"rolling": {"grade": 0.05, "seed": i}}, "seed": i}
        simulate_drive(folder / f"unit-{i}" / "2026-03-02.csv", "husky-a200", world, {"kind": "rich", "duration_s": 150.0, "seed": i})
    return folder


def documents(folder):
    """All documents of a folder, by name."""
    return {file.name: json.loads(file.read_text()) for file in sorted(folder.glob("*.json"))}
