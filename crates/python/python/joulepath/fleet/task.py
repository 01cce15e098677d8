"""One recording from its file to its report in the storage: what runs on the machines of the cluster."""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import dataclass
from typing import Any

import joulepath

from . import compute
from .drives import Drive
from .question import Question
from .storage import Storage, content_id, id_of, local_copy

DONE, FAILED = "done", "failed"
LEAST_FAULT = 500
"""Least status of a problem that is the machine's: the recording may be answered another time."""


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
            return brief(piece.drive, FAILED, problem=fault(f"cannot read {error.filename or piece.drive.path}: {error.strerror}"))
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


def fault(detail: str) -> dict[str, Any]:
    """A problem of the machines, not of the recording: asked again, it may be gone."""
    return joulepath.Error(detail).to_dict()


def _job(question: Question, id: str, recording: Any, healthy: list[Any]) -> dict[str, Any]:
    """The job as the service would have it after its end."""
    job = {"id": id, "kind": question.kind, "state": DONE, "attempt": 1, "progress": {"step": question.kind, "fraction": 1.0}}
    try:
        return {**job, "result": compute.answer(question, recording, healthy)}
    except joulepath.Error as error:
        if error.status >= LEAST_FAULT:
            raise OSError(error.detail) from error
        return {**job, "state": FAILED, "problem": error.to_dict()}


def _job_id(question: Question, recording: tuple[str, str], healthy: list[tuple[str, str]]) -> str:
    """The hash of a job's description, which has the form of the service's own."""
    map = question.options.get("map")
    named = {"recordings": [recording], "reference": healthy}
    inputs = {field: [{"id": id, "name": name, "map": map} for id, name in files] for field, files in named.items()}
    request = question.request([recording[0]], [id for id, _ in healthy])
    return id_of({"kind": question.kind, "version": compute.version(), "request": request, "inputs": inputs})
