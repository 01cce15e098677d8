"""Ray nodes of this machine, on addresses of the loopback, ended by their ids."""

import contextlib
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

HEAD, OTHER = "127.0.0.2", "127.0.0.3"
START_TIME_S = 120.0
END_TIME_S = 5.0
OBJECT_STORE_BYTES = 80_000_000
"""Smallest store that Ray takes; outcomes are short."""


class Node:
    """A Ray node: a process group of its own."""

    def __init__(self, words, room):
        self.log = open(room / f"{words[-1]}.log", "w")
        command = [sys.executable, "-m", "ray.scripts.scripts", "start", "--block", *words]
        self.process = subprocess.Popen(command, stdout=self.log, stderr=self.log, start_new_session=True)

    def end(self, number=signal.SIGTERM):
        """Ends the node and all that it started."""
        self._signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(timeout=END_TIME_S)
        self._signal(signal.SIGKILL)
        self.process.wait()
        self.log.close()

    def _signal(self, number):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, number)


class Cluster:
    """A head, another node that comes and goes, and a driver that is connected. Each node has one core."""

    def __init__(self):
        # Paths of Ray's sockets must be short.
        self.room = Path("/tmp", f"jp-{secrets.token_hex(4)}")
        self.room.mkdir(mode=0o700)
        token = self.room / "token"
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
        with socket.socket() as free:
            free.bind((HEAD, 0))
            port = str(free.getsockname()[1])
        self.address = f"{HEAD}:{port}"
        self.shared = ["--object-store-memory", str(OBJECT_STORE_BYTES), "--num-cpus", "1", "--disable-usage-stats"]
        head = ["--head", "--port", port, "--include-dashboard=false", "--temp-dir", str(self.room / "ray"), *self.shared]
        self.nodes = {HEAD: Node([*head, "--node-ip-address", HEAD], self.room)}

    def connect(self):
        """Connects this process, once the head is there."""
        import ray

        def tried():
            try:
                ray.init(address=self.address, _node_ip_address=HEAD, log_to_driver=False, logging_level="ERROR")
            except (ConnectionError, RuntimeError, ValueError):
                return False
            return True

        _await(tried, "the head")

    def add(self):
        """Starts the other node and waits for it."""
        import ray

        self.nodes[OTHER] = Node(["--address", self.address, *self.shared, "--node-ip-address", OTHER], self.room)
        _await(lambda: ray.cluster_resources().get("CPU") == 2.0, "the second node")

    def kill(self, node):
        """Ends a node as a power cut would."""
        self.nodes.pop(node).end(signal.SIGKILL)

    def end(self):
        """Ends all nodes and leaves nothing behind."""
        import ray

        ray.shutdown()
        for node in list(self.nodes):
            self.nodes.pop(node).end()
        shutil.rmtree(self.room, ignore_errors=True)


def _await(condition, what):
    end_s = time.monotonic() + START_TIME_S
    while not condition():
        assert time.monotonic() < end_s, f"{what} did not come within {START_TIME_S} s"
        time.sleep(0.2)
