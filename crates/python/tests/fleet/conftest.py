"""Two Ray nodes on the loopback, each with one core, and a few recordings."""

import contextlib
import json
import os
import secrets
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

HEAD, OTHER = "127.0.0.2", "127.0.0.3"
START_TIME_S = 120.0
OBJECT_STORE_BYTES = 80_000_000


class Node:
    """A Ray node of this machine: a process group of its own, which is ended by its id."""

    def __init__(self, words, room):
        ray = [sys.executable, "-m", "ray.scripts.scripts"]
        self.log = open(room / f"{words[-1]}.log", "w")
        self.process = subprocess.Popen([*ray, "start", "--block", *words], stdout=self.log, stderr=self.log, start_new_session=True)

    def end(self, number=signal.SIGTERM):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, number)
        try:
            self.process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
        # What the leader has left of its group, if anything.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.log.close()


class Cluster:
    """A head and nodes that come and go."""

    def __init__(self, room):
        self.room = room
        with __import__("socket").socket() as free:
            free.bind((HEAD, 0))
            self.address = f"{HEAD}:{free.getsockname()[1]}"
        port = self.address.rpartition(":")[2]
        memory = ["--object-store-memory", str(OBJECT_STORE_BYTES), "--num-cpus", "1", "--disable-usage-stats"]
        head = ["--head", "--port", port, "--include-dashboard=false", "--temp-dir", str(room / "ray"), *memory]
        self.nodes = {HEAD: Node([*head, "--node-ip-address", HEAD], room)}
        self.memory = memory

    def add(self):
        self.nodes[OTHER] = Node(["--address", self.address, *self.memory, "--node-ip-address", OTHER], self.room)

    def kill(self, node):
        self.nodes.pop(node).end(signal.SIGKILL)

    def end(self):
        for node in list(self.nodes):
            self.nodes.pop(node).end()


@pytest.fixture(scope="session")
def cluster(tmp_path_factory):
    """A cluster to which the driver of these tests is connected."""
    ray = pytest.importorskip("ray")
    # Paths of Ray's sockets must be short.
    room = Path("/tmp", f"jp-{secrets.token_hex(4)}")
    room.mkdir(mode=0o700)
    token = room / "token"
    token.write_text(secrets.token_hex(32))
    os.environ.update(
        RAY_AUTH_MODE="token",
        RAY_AUTH_TOKEN_PATH=str(token),
        RAY_USAGE_STATS_ENABLED="0",
        # A dead node is noticed in seconds.
        RAY_health_check_period_ms="1000",
        RAY_health_check_failure_threshold="5",
        RAY_health_check_initial_delay_ms="1000",
    )
    found = Cluster(room)
    try:
        _connect(ray, found)
        found.add()
        _await(lambda: ray.cluster_resources().get("CPU") == 2.0, "the second node")
        yield found
    finally:
        ray.shutdown()
        found.end()
        __import__("shutil").rmtree(room, ignore_errors=True)


def _connect(ray, cluster):
    def tried():
        try:
            ray.init(address=cluster.address, _node_ip_address=HEAD, log_to_driver=False, logging_level="ERROR")
        except (ConnectionError, RuntimeError, ValueError):
            return False
        return True

    _await(tried, "the head")


def _await(condition, what):
    end_s = time.monotonic() + START_TIME_S
    while not condition():
        assert time.monotonic() < end_s, f"{what} did not come within {START_TIME_S} s"
        time.sleep(0.2)


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
    from joulepath.fleet.example import _simulate

    folder = tmp_path_factory.mktemp("logs")
    for i in range(3):
        world = {"terrain": {"rolling": {"grade": 0.05, "seed": i}}, "seed": i}
        _simulate(folder / f"unit-{i}" / "2026-03-02.csv", "husky-a200", world, {"kind": "rich", "duration_s": 150.0, "seed": i})
    return folder


def documents(folder):
    """All documents of a folder, by name."""
    return {file.name: json.loads(file.read_text()) for file in sorted(folder.glob("*.json"))}
