"""Arguments as the JSON documents of the HTTP API."""

from __future__ import annotations

import json
import math
from typing import Any

from .errors import InvalidRequestError, NotANumberError


def plain(value: Any) -> Any:
    """Numbers and arrays of numpy as those of Python; what has a document as that."""
    for method in ("tolist", "to_dict"):
        if hasattr(value, method):
            return getattr(value, method)()
    raise TypeError(f"{type(value).__name__} has no JSON")


def encode(body: dict[str, Any]) -> str:
    """A request's body without the arguments that are not given.

    Raises ``NotANumberError`` or ``InvalidRequestError`` with the pointer of what has no JSON.
    """
    given = {name: value for name, value in body.items() if value is not None}
    try:
        return json.dumps(given, default=plain, allow_nan=False)
    except (TypeError, ValueError):
        raise _fault(given, "") or InvalidRequestError("the arguments hold themselves") from None


def _fault(value: Any, pointer: str) -> InvalidRequestError | None:
    """What of a value has no JSON, with its place."""
    if isinstance(value, dict):
        parts = ((str(key), part) for key, part in value.items())
    elif isinstance(value, (list, tuple)):
        parts = ((str(index), part) for index, part in enumerate(value))
    else:
        return _fault_of_one(value, pointer)
    faults = (_fault(part, f"{pointer}/{key.replace('~', '~0').replace('/', '~1')}") for key, part in parts)
    return next((fault for fault in faults if fault is not None), None)


def _fault_of_one(value: Any, pointer: str) -> InvalidRequestError | None:
    name = pointer.lstrip("/").replace("/", ".")
    if isinstance(value, float) and not math.isfinite(value):
        return NotANumberError(f"{name} is {value}: give a number, or leave it out", pointer=pointer)
    if value is None or isinstance(value, (str, int, float)):
        return None
    try:
        return _fault(plain(value), pointer)
    except (TypeError, AttributeError):
        kind = type(value).__name__
        return InvalidRequestError(f"{name} is a {kind}: give a number, a text, a list or a dict", pointer=pointer)


def pose(value: Any, name: str) -> dict[str, Any]:
    """A place as the API has it; ``(x_m, y_m)`` and ``(x_m, y_m, heading_rad)`` are places too."""
    if isinstance(value, dict):
        return value
    try:
        numbers = [float(number) for number in value]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) not in (2, 3):
        detail = f"{name} is {value!r}: give (x_m, y_m), (x_m, y_m, heading_rad) or a dict of x_m, y_m, or of lon_deg, lat_deg"
        raise InvalidRequestError(detail, pointer=f"/{name}")
    return dict(zip(("x_m", "y_m", "heading_rad"), numbers))


def poses(values: Any, name: str) -> list[dict[str, Any]] | None:
    """Places as the API has them."""
    if values is None:
        return None
    return [pose(value, f"{name}/{index}") for index, value in enumerate(values)]
