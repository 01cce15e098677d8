"""One recording from its file to its report in the storage: what runs on the machines of the cluster."""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import dataclass
from typing import Any

from . import compute
from .drives import Drive
from .question import Question, Unanswerable
from .storage import Storage, content_id, id_of, local_copy

DONE, FAILED = "done", "failed"


@dataclass(frozen=True)
class Piece:
    """One recording with what it is compared with."""

    drive: Drive
    healthy: tuple[Drive, ...] = ()
    """Drives of the same unit that are known to be healthy."""


@dataclass(frozen=True)
class Shared:
    """What all tasks of a run have in common."""

    question: Question
    place: str
    """Where results are kept."""
    tenant: str


def report_on(shared: Shared, piece: Piece) -> dict[str, Any]:
    """Answers the question of one recording, unless its report is there already, and returns what became of it in brief.

    The report is named after the content of all that it depends on. It is written as a whole, so that a task that is done twice, or was killed
    while it wrote, leaves one report. Raises `OSError` where the storage or a file is out of reach for the moment.
    """
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    began_s = time.monotonic()
    storage = Storage(shared.place, shared.tenant)
    question = shared.question
    with contextlib.ExitStack() as copies:
        try:
            recording = copies.enter_context(local_copy(piece.drive.path))
            healthy = [copies.enter_context(local_copy(drive.path)) for drive in piece.healthy]
            recording_id, healthy_ids = content_id(recording), [content_id(one) for one in healthy]
        except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
            return brief(piece.drive, FAILED, problem=problem("internal", f"cannot read {error.filename or piece.drive.path}: {error.strerror}"))
        id = _job_id(question, (recording_id, recording.name), list(zip(healthy_ids, (one.name for one in healthy), strict=True)))
        known = storage.read(storage.report_name(id))
        if known is not None:
            job = known["job"]
            return brief(piece.drive, job["state"], recording_id, id, reused=True, problem=job.get("problem"))
        job = _job(question, id, recording, healthy)
    storage.write(storage.report_name(id), {"sequence": 1, "job": job})
    spent_s = time.monotonic() - began_s
    return brief(piece.drive, job["state"], recording_id, id, problem=job.get("problem"), spent_s=spent_s)


def brief(
    drive: Drive,
    state: str,
    recording_id: str | None = None,
    job_id: str | None = None,
    *,
    reused: bool = False,
    problem: dict[str, Any] | None = None,
    spent_s: float | None = None,
) -> dict[str, Any]:
    """What a run keeps of one recording."""
    return {
        **drive.to_dict(),
        "state": state,
        "recording_id": recording_id,
        "job_id": job_id,
        "reused": reused,
        "problem": problem,
        "spent_s": spent_s,
    }


def problem(type: str, detail: str, errors: list[dict[str, str]] | None = None) -> dict[str, Any]:
    """A problem document as the service keeps it."""
    titles = {"internal": ("Internal error", 500), "insufficient-recording": ("The recording does not suffice", 422)}
    titles["unknown-surface"] = ("A surface is unknown", 422)
    title, status = titles.get(type, (f"The {type.removeprefix('invalid-')} cannot be used", 400))
    document = {"type": type, "title": title, "status": status, "detail": detail}
    return {**document, "errors": errors} if errors else document


def _job(question: Question, id: str, recording: Any, healthy: list[Any]) -> dict[str, Any]:
    """The job as the service would have it after its end."""
    job = {"id": id, "kind": question.kind, "state": DONE, "attempt": 1, "progress": {"step": question.kind, "fraction": 1.0}}
    try:
        return {**job, "result": compute.answer(question, recording, healthy)}
    except Unanswerable as error:
        return {**job, "state": FAILED, "problem": problem(error.type, error.detail, error.errors)}


def _job_id(question: Question, recording: tuple[str, str], healthy: list[tuple[str, str]]) -> str:
    """The hash of a job's description, which has the form of the service's own."""
    map = question.options.get("map")
    named = {"recordings": [recording], "reference": healthy}
    inputs = {field: [{"id": id, "name": name, "map": map} for id, name in files] for field, files in named.items()}
    request = question.request([recording[0]], [id for id, _ in healthy])
    return id_of({"kind": question.kind, "version": compute.version(), "request": request, "inputs": inputs})
