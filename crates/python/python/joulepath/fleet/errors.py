"""What can be wrong with a question to a fleet."""

from __future__ import annotations


class FleetError(Exception):
    """A question that cannot be answered, with its kind and the mend.

    `type` is a word for programs, as the HTTP API's problem documents have it; the text says what is wrong and how to mend it.
    """

    def __init__(self, type: str, detail: str) -> None:
        super().__init__(detail)
        self.type = type
        self.detail = detail

    def __reduce__(self) -> tuple[type[FleetError], tuple[str, str]]:
        return (FleetError, (self.type, self.detail))
