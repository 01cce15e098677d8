"""Progress of long work, shown or told."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, Union

#: How progress is followed: a function of the step and the share that is done (0 to 1); true to show a line; false for nothing; ``None``
#: to show it in notebooks and on terminals.
Progress = Union[Callable[[str, float], Any], bool, None]


def told(progress: Progress) -> Callable[[str, float], Any] | None:
    """What is called with each step, if anything is."""
    if callable(progress):
        return progress
    shown = _is_interactive() if progress is None else progress
    return _notebook() or _line if shown else None


def _is_interactive() -> bool:
    return "ipykernel" in sys.modules or (hasattr(sys, "ps1") and sys.stderr.isatty())


def _notebook() -> Callable[[str, float], Any] | None:
    """A line below the cell that changes in its place; ``None`` outside notebooks."""
    if "ipykernel" not in sys.modules:
        return None
    from IPython.display import HTML, display

    handle = display(HTML("<progress max='1' value='0'></progress>"), display_id=True)

    def show(step: str, share: float) -> None:
        handle.update(HTML(f"<progress max='1' value='{share:.3f}'></progress> {step}"))

    return show


def _line(step: str, share: float) -> None:
    sys.stderr.write(f"\r{100 * share:3.0f} % {step:<60}" + ("\n" if share >= 1 else ""))
    sys.stderr.flush()
