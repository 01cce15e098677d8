"""The time that a piece of work may take on the machine where it runs."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any

MOST_GRACE_S = 10.0
"""How long a piece may go on at most after its time is over before its worker is ended [s]. Computations of joulepath end within 0.1 s; what
is stuck in a call of the system may never."""
LEAST_GRACE_S = 1.0
"""The same however short its time is [s]: ten times what computations need on a machine that is not busy."""


class Lost(Exception):
    """A piece of which nothing came, however often it was tried; says why."""


class _OutOfTime(BaseException):
    """The time is over. No handler of errors takes it for one of its own."""


def limited(work: Callable[..., Any], limit_s: float | None, shared: Any, piece: Any) -> Any:
    """Returns `work(shared, piece)`, or a [`Lost`] where that takes longer than the limit [s]."""
    if limit_s is None:
        return work(shared, piece)
    try:
        with _time_limit(limit_s):
            return work(shared, piece)
    except _OutOfTime:
        return Lost(f"it took longer than {limit_s:g} s, the most that a task may take (task_timeout_s)")


@contextlib.contextmanager
def _time_limit(limit_s: float) -> Iterator[None]:
    """Raises [`_OutOfTime`] in the main thread after the limit, and ends the process where that does not help."""
    last_resort = threading.Timer(limit_s + max(LEAST_GRACE_S, min(limit_s, MOST_GRACE_S)), os._exit, [1])
    last_resort.daemon = True
    last_resort.start()
    try:
        with _alarm(limit_s):
            yield
    finally:
        last_resort.cancel()


@contextlib.contextmanager
def _alarm(limit_s: float) -> Iterator[None]:
    """Raises [`_OutOfTime`] after the limit, where the system has alarms and this is the thread that hears them."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGALRM, _raise)
    try:
        signal.setitimer(signal.ITIMER_REAL, limit_s)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _raise(*_: Any) -> None:
    raise _OutOfTime
