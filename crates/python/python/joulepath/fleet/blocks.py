"""Blocks of a large computation: each is kept in the storage by the hash of what it depends on, and worked out once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import joulepath

from .._progress import Progress, told
from .cluster import Lost, Ways, connected, spread
from .storage import Storage, id_of
from .task import LEAST_FAULT

@dataclass(frozen=True)
class Work:
    """How a block is worked out and where it is kept."""

    kind: str
    """First part of the blocks' names in the storage, below `fleet/`."""
    compute: Callable[[Any], Any]
    """Works out a block from what it depends on. Raises a `joulepath.Error` where the block itself is at fault."""
    place: str


def answered(
    work: Work, blocks: Sequence[dict[str, Any]], ways: Ways, progress: Progress = None
) -> list[dict[str, Any]]:
    """Returns for every block, in their order, `{"result"}`, or `{"failed"}` with the reason."""
    answers: list[dict[str, Any]] = [{} for _ in blocks]
    tell = told(progress)
    with connected(ways) as ray:
        for done, (number, answer) in enumerate(spread(ray, ways, _answer, work, blocks), 1):
            answers[number] = {"failed": str(answer)} if isinstance(answer, Lost) else answer
            if tell is not None:
                tell(f"{done} of {len(blocks)} blocks", done / len(blocks))
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
