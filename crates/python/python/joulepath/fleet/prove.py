"""The concealed trial on a cluster: thousands of cases, a block of them a task."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._progress import Progress
from . import compute
from .blocks import Work, answered
from .cluster import Ways
from .command import called, robot_words
from .errors import FleetError
from .question import robot_document
from .storage import Storage

BLOCK_CASES = 10
"""Cases of a block: some minutes of one core, so that a machine that dies costs no more."""
SCOREBOARD = "scoreboard.json"
"""What a trial leaves, and what trials are added up from."""


@dataclass(frozen=True)
class FleetTrial:
    """A trial, added up from its blocks."""

    cases: int
    """Cases that were scored."""
    summary: str
    """The scoreboard in words, as `joulepath prove` prints it; empty where no block was scored."""
    failed: list[dict[str, Any]]
    """`seed`, `cases` and `reason` of every block of which nothing came."""

    def to_dict(self) -> dict[str, Any]:
        """The trial as a document."""
        return {"cases": self.cases, "summary": self.summary.splitlines(), "failed": self.failed}

    def __str__(self) -> str:
        lines = [f"{self.cases} cases scored, {sum(one['cases'] for one in self.failed)} lost", self.summary]
        return "\n".join(lines + [f"  failed: {one['cases']} cases of seed {one['seed']}: {one['reason']}" for one in self.failed])


def prove(
    cases: int,
    *,
    seed: int = 1,
    robot: Any = "husky-a200",
    storage: str | os.PathLike[str] | Storage,
    block_cases: int = BLOCK_CASES,
    ways: Ways = Ways(),
    progress: Progress = None,
) -> FleetTrial:
    """Conceals effects in `cases` drives, diagnoses them without the keys and scores what was found.

    Block i is the trial of `joulepath prove --seed seed+i`, whose commitment to its keys stands in its scoreboard in the storage. Blocks are added
    up by `joulepath prove --together`. Raises a [`FleetError`] where the question itself is wrong; blocks that fail are counted and named.
    """
    if cases < 1 or block_cases < 1 or seed < 0:
        raise FleetError("invalid-request", f"cases and block_cases must be 1 or more and seed 0 or more, not {cases}, {block_cases}, {seed}")
    storage = storage if isinstance(storage, Storage) else Storage(storage)
    document = robot_document(robot)
    blocks = [
        {"robot": document, "seed": seed + i, "cases": min(block_cases, cases - start), "version": compute.version()}
        for i, start in enumerate(range(0, cases, block_cases))
    ]
    answers = answered(Work("prove", _block, storage.place), blocks, ways, progress)
    scored = [answer["result"] for answer in answers if "result" in answer]
    pairs = zip(blocks, answers, strict=True)
    failed = [{"seed": block["seed"], "cases": block["cases"], "reason": answer["failed"]} for block, answer in pairs if "failed" in answer]
    return FleetTrial(cases - sum(one["cases"] for one in failed), _together(scored) if scored else "", failed)


def _block(block: dict[str, Any]) -> dict[str, Any]:
    """The scoreboard of a block."""
    with tempfile.TemporaryDirectory(prefix="joulepath-fleet-") as room:
        out = Path(room, "trial")
        robot = robot_words(block["robot"], Path(room))
        called(["prove", *robot, "--cases", str(block["cases"]), "--seed", str(block["seed"]), "--out", out])
        return json.loads(Path(out, SCOREBOARD).read_text())


def _together(scoreboards: list[dict[str, Any]]) -> str:
    """The figures of all blocks, in words."""
    with tempfile.TemporaryDirectory(prefix="joulepath-fleet-") as room:
        folders = []
        for i, scoreboard in enumerate(scoreboards):
            folder = Path(room, str(i))
            folder.mkdir()
            Path(folder, SCOREBOARD).write_text(json.dumps(scoreboard))
            folders.append(str(folder))
        return called(["prove", "--together", *folders]).strip()
