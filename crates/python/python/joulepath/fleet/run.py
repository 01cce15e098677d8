"""A question to every recording of a fleet: what came of each, and where it is kept."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import joulepath

from .._optional import needed
from .._progress import Progress, told
from .cluster import Lost, Ways, connected, spread
from .drives import Drive
from .errors import FleetError
from .question import Question
from .storage import Storage, id_of
from .task import DONE, FAILED, Piece, Shared, brief, fault, report_on

DUPLICATE = "duplicate"
"""State of a recording that has the content of another one of the run, and counts once."""
RUNS = "fleet/runs"
"""Where runs are kept in the storage."""

@dataclass(frozen=True)
class Counts:
    """How many recordings ended how."""

    total: int
    """Recordings that were asked about."""
    done: int = 0
    """Those that have a result."""
    failed: int = 0
    """Those of which nothing came; each is named with the reason."""
    duplicate: int = 0
    """Those whose content is that of another."""
    reused: int = 0
    """Those among the ended whose report was there already."""

    @property
    def ended(self) -> int:
        """Recordings that are through."""
        return self.done + self.failed + self.duplicate

    def __str__(self) -> str:
        parts = [f"{self.ended} of {self.total} recordings", f"{self.done} done"]
        parts += [f"{count} {name}" for count, name in ((self.failed, "failed"), (self.duplicate, "duplicate")) if count]
        return ", ".join(parts) + (f" ({self.reused} were there before)" if self.reused else "")


@dataclass(frozen=True)
class Run:
    """What came of a question to every recording."""

    id: str
    """Hash of the question and of which recordings it was asked."""
    kind: str
    """`diagnose` or `calibrate`."""
    outcomes: list[dict[str, Any]]
    """One for each recording, in the order asked: path, unit, date, state (`done`, `failed`, `duplicate`), recording_id, job_id, reused,
    problem, spent_s."""
    notes: list[str]
    """What a reader should know of the run as a whole."""

    @property
    def counts(self) -> Counts:
        """How many recordings ended how."""
        return counted(self.outcomes, len(self.outcomes))

    @property
    def failed(self) -> list[dict[str, Any]]:
        """The recordings of which nothing came, with their problems."""
        return [outcome for outcome in self.outcomes if outcome["state"] == FAILED]

    def results(self, storage: Storage) -> list[dict[str, Any]]:
        """Reads the result of every recording that has one, each beside its outcome as `result`."""
        found = []
        for outcome in self.outcomes:
            if outcome["state"] != DONE:
                continue
            report = storage.read(storage.report_name(outcome["job_id"]))
            if report is None:
                raise FleetError(
                    "unknown-job",
                    f"{outcome['path']}: its report {outcome['job_id']} is no longer in the storage; ask for the run again to compute it anew",
                )
            found.append({**outcome, "result": report["job"]["result"]})
        return found

    def to_dict(self) -> dict[str, Any]:
        """The run as a document."""
        counts = self.counts
        by_state = {"total": counts.total, "done": counts.done, "failed": counts.failed, "duplicate": counts.duplicate, "reused": counts.reused}
        return {"id": self.id, "kind": self.kind, "counts": by_state, "notes": self.notes, "outcomes": self.outcomes}

    def to_pandas(self) -> Any:
        """The outcomes as a `pandas.DataFrame`, a row for each recording."""
        return needed("pandas").DataFrame(self.outcomes)

    def __str__(self) -> str:
        lines = [f"{self.kind} {self.id}: {self.counts}", *self.notes]
        lines += [f"  failed: {one['path']} ({one['unit']}): {one['problem']['detail']}" for one in self.failed]
        return "\n".join(lines)


def ask(
    question: Question,
    drives: Sequence[Drive],
    storage: Storage,
    *,
    healthy: Sequence[Drive] = (),
    ways: Ways = Ways(),
    progress: Progress = None,
) -> Run:
    """Asks a question of every recording on the cluster and writes the run down.

    Reports that are in the storage are not computed again, so that a run whose driver died is taken up by asking again.
    """
    if not drives:
        raise FleetError("invalid-request", "paths: there is no recording to ask about")
    by_unit: dict[str, list[Drive]] = {}
    for drive in healthy:
        by_unit.setdefault(drive.unit, []).append(drive)
    pieces = [Piece(drive, tuple(one for one in by_unit.get(drive.unit, ()) if one.path != drive.path)) for drive in drives]
    outcomes: list[dict[str, Any] | None] = [None] * len(pieces)
    tell = told(progress)
    with connected(ways) as ray:
        shared = Shared(question, storage.place, storage.tenant)
        for number, outcome in spread(ray, ways, report_on, shared, pieces):
            if isinstance(outcome, Lost):
                outcome = brief(pieces[number].drive, FAILED, problem=fault(str(outcome)))
            outcomes[number] = outcome
            counts = counted([one for one in outcomes if one is not None], len(pieces))
            if tell is not None:
                tell(str(counts), counts.ended / counts.total)
    run = Run(_run_id(question, pieces), question.kind, _without_duplicates([one for one in outcomes if one is not None]), _notes(pieces, by_unit))
    storage.write(f"{RUNS}/{run.id}.json", {"written": datetime.datetime.now(datetime.timezone.utc).isoformat(), **run.to_dict()})
    return run


def read_runs(storage: Storage, kind: str) -> list[Run]:
    """Returns the runs of a kind that the storage holds, the latest last."""
    documents: list[dict[str, Any]] = [one for name in storage.names(RUNS) if (one := storage.read(name)) is not None]
    documents = sorted((one for one in documents if one["kind"] == kind), key=lambda one: one["written"])
    return [Run(one["id"], one["kind"], one["outcomes"], one["notes"]) for one in documents]


def counted(outcomes: list[dict[str, Any]], total: int) -> Counts:
    """How many recordings ended how."""
    states = [outcome["state"] for outcome in outcomes]
    reused = sum(outcome["reused"] for outcome in outcomes)
    return Counts(total, states.count(DONE), states.count(FAILED), states.count(DUPLICATE), reused)


def _without_duplicates(outcomes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Every content counts once: the first recording that has it stands for all."""
    first: dict[str, dict[str, Any]] = {}
    kept = []
    for outcome in outcomes:
        known = first.setdefault(outcome["recording_id"], outcome) if outcome["recording_id"] else outcome
        if known is not outcome:
            detail = f"it has the same content as {known['path']} of {known['unit']}"
            outcome = {**outcome, "state": DUPLICATE, "problem": joulepath.errors.InvalidRecordingError(detail).to_dict()}
        kept.append(outcome)
    return kept


def _notes(pieces: list[Piece], healthy: dict[str, list[Drive]]) -> list[str]:
    alone = sorted({piece.drive.unit for piece in pieces if not piece.healthy}) if healthy else []
    undated = sum(piece.drive.date is None for piece in pieces)
    notes = [f"no healthy drives of {', '.join(alone)}: compared with the robot file alone"] if alone else []
    return notes + ([f"{undated} recordings have no date: they tell nothing of changes over weeks"] if undated else [])


def _run_id(question: Question, pieces: list[Piece]) -> str:
    listed = [[piece.drive.to_dict(), [drive.path for drive in piece.healthy]] for piece in pieces]
    return id_of({"kind": question.kind, "request": question.request([], []), "drives": listed})
