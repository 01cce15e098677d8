"""Work spread over a Ray cluster: so much under way at a time, repeated where machines fail, one outcome for each piece.

Ray schedules, restarts and notices dead machines. What stands here is how much it is given at a time, and what becomes of pieces that fail.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from .._optional import needed
from .errors import FleetError
from .time_limit import Lost, limited

LOOPBACK = "127.0.0.2"
"""Address of a Ray that is started here for one call. Ray takes 127.0.0.1 for the machine's outside address; 127.0.0.2 is the machine's own as
well where the system is Linux."""
QUEUED_PER_CORE = 2
"""Pieces that are handed to Ray for each core: one under way and one that waits, so that no core idles and the rest stays here."""
LOOK_AROUND_S = 5.0
"""How long to wait before the size of the cluster is looked at again [s]: machines may have come or gone."""


@dataclass(frozen=True)
class Ways:
    """How a fleet's work is done."""

    address: str | None = None
    """Address of the cluster, as `127.0.0.1:6379` or `auto`. Default: that of `RAY_ADDRESS`, else a Ray of this machine for this call."""
    cores_per_task: int = 1
    """Cores that a piece of work takes."""
    retries: int = 3
    """How often a piece is repeated whose worker or machine died, or whose files were out of reach."""
    in_flight: int | None = None
    """Most pieces that Ray is given at a time. Default: twice what its cores can do at once."""
    task_timeout_s: float | None = 3600.0
    """Most time that a piece may take [s], so that one that hangs does not hold a core for ever: it is counted as failed and not repeated.
    None: no limit."""

    def check(self) -> None:
        """Refuses ways that cannot be gone."""
        if self.cores_per_task < 1 or self.retries < 0 or (self.in_flight is not None and self.in_flight < 1):
            raise FleetError(
                "invalid-request",
                f"cores_per_task and in_flight must be 1 or more and retries 0 or more, not {self.cores_per_task}, {self.in_flight} and "
                f"{self.retries}",
            )
        if self.task_timeout_s is not None and not 0.0 < self.task_timeout_s < float("inf"):
            raise FleetError("invalid-request", f"task_timeout_s must be a number of seconds above 0, or None for no limit, not {self.task_timeout_s}")


@contextlib.contextmanager
def connected(ways: Ways) -> Iterator[Any]:
    """Gives Ray, connected to the cluster meant; leaves a connection alone that was there before."""
    ways.check()
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    ray = needed("ray")
    if ray.is_initialized():
        yield ray
        return
    address = ways.address or os.environ.get("RAY_ADDRESS")
    try:
        ray.init(address=address, log_to_driver=False, logging_level="ERROR", **_own_address(address))
    except (ConnectionError, RuntimeError, ValueError, OSError) as error:
        raise FleetError(
            "no-ray",
            f"there is no Ray at {address or 'this machine'} that lets us in ({str(error).splitlines()[0]}): start one with `ray start --head "
            f"--node-ip-address {LOOPBACK}`, give RAY_AUTH_MODE and RAY_AUTH_TOKEN_PATH the values that it has, or leave the address out to "
            "start one for this call",
        ) from error
    try:
        yield ray
    finally:
        ray.shutdown()


def _own_address(cluster: str | None) -> dict[str, Any]:
    """Which address of this machine Ray is to use: that of the loopback where the cluster is there, or is started for this call."""
    if not cluster:
        return {"include_dashboard": False, **({"_node_ip_address": LOOPBACK} if sys.platform == "linux" else {})}
    host = cluster.removeprefix("ray://").rpartition(":")[0]
    return {"_node_ip_address": host} if host.startswith("127.") else {}


def spread(ray: Any, ways: Ways, work: Callable[..., Any], shared: Any, pieces: Sequence[Any]) -> Iterator[tuple[int, Any]]:
    """Gives the outcome of `work(shared, piece)` for every piece, as they come, each with its piece's number.

    The outcome is a [`Lost`] where a piece was tried as often as it may be, or took longer than it may. Nothing is handed to Ray before there is room for it. Whoever stops
    listening calls off what is still under way.
    """
    remote = ray.remote(num_cpus=ways.cores_per_task, max_retries=ways.retries, retry_exceptions=[OSError])(limited)
    shared = ray.put(shared)
    waiting = iter(enumerate(pieces))
    under_way: dict[Any, int] = {}
    exhausted = False
    try:
        while True:
            room = _room(ray, ways) - len(under_way)
            while room > 0 and not exhausted:
                number, piece = next(waiting, (-1, None))
                exhausted = number < 0
                if not exhausted:
                    under_way[remote.remote(work, ways.task_timeout_s, shared, piece)] = number
                    room -= 1
            if not under_way:
                return
            done, _ = ray.wait(list(under_way), num_returns=1, timeout=LOOK_AROUND_S)
            for reference in done:
                yield under_way.pop(reference), _outcome(ray, ways, reference)
    finally:
        for reference in under_way:
            ray.cancel(reference, force=True)


def _room(ray: Any, ways: Ways) -> int:
    """How many pieces Ray may have at the moment."""
    if ways.in_flight is not None:
        return ways.in_flight
    cores = ray.cluster_resources().get("CPU", 0.0)
    return max(1, QUEUED_PER_CORE * int(cores // ways.cores_per_task))


def _outcome(ray: Any, ways: Ways, reference: Any) -> Any:
    try:
        return ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        cause = error.cause if isinstance(error.cause, Exception) else error
        return Lost(f"{type(cause).__name__}: {cause}")
    except ray.exceptions.RayError as error:
        limit = f", or it took longer than {ways.task_timeout_s:g} s and did not heed it" if ways.task_timeout_s is not None else ""
        return Lost(f"the machine or its worker died every time that it was tried ({type(error).__name__}){limit}")
