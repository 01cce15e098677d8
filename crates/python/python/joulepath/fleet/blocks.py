"""Blocks of a large computation: each is kept in the storage by the hash of what it depends on, and worked out once."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import joulepath

from .cluster import Lost, Ways, connected, spread
from .storage import Storage, id_of
from .task import LEAST_FAULT

BlockProgress = Callable[[int, int], None]
"""Is told after every block how many of how many have ended."""


@dataclass(frozen=True)
class Work:
    """How a block is worked out and where it is kept."""

    kind: str
    """First part of the blocks' names in the storage, below `fleet/`."""
    compute: Callable[[Any], Any]
    """Works out a block from what it depends on. Raises a `joulepath.Error` where the block itself is at fault."""
    place: str


def answered(
    work: Work, blocks: Sequence[dict[str, Any]], ways: Ways, progress: BlockProgress | None = None
) -> list[dict[str, Any]]:
    """Returns for every block, in their order, `{"result"}`, or `{"failed"}` with the reason."""
    answers: list[dict[str, Any]] = [{} for _ in blocks]
    tell = progress or _on_terminal
    with connected(ways) as ray:
        for done, (number, answer) in enumerate(spread(ray, ways, _answer, work, blocks), 1):
            answers[number] = {"failed": str(answer)} if isinstance(answer, Lost) else answer
            tell(done, len(blocks))
    return answers


def _answer(work: Work, block: dict[str, Any]) -> dict[str, Any]:
    """The answer of one block, which may be there already."""
    storage = Storage(work.place)
    name = f"fleet/{work.kind}/{id_of(block)}.json"
    known = storage.read(name)
    if known is not None:
        return known
    try:
        answer = {"result": work.compute(block)}
    except joulepath.Error as error:
        if error.status >= LEAST_FAULT:
            raise OSError(error.detail) from error
        answer = {"failed": error.detail}
    storage.write(name, answer)
    return answer


def _on_terminal(done: int, total: int) -> None:
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{done} of {total} blocks" + ("\n" if done == total else ""))
        sys.stderr.flush()
