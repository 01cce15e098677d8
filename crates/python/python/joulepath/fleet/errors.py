"""What can be wrong with a question to a fleet."""

from __future__ import annotations

import joulepath


class FleetError(joulepath.Error):
    """A question that cannot be answered; the detail says what is wrong and how to mend it."""

    def __init__(self, type: str, detail: str) -> None:
        super().__init__(detail)
        self.type = type
        self.title, self.status = ("The request cannot be read", 400) if type.startswith("invalid-") else ("The fleet cannot be asked", 503)

    def __reduce__(self) -> tuple[type[FleetError], tuple[str, str]]:
        return FleetError, (self.type, self.detail)
