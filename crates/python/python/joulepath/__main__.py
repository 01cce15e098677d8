"""The `joulepath` command, also as `python3 -m joulepath`."""

from __future__ import annotations

import os
import signal
import sys

from . import _native

ITSELF = [sys.executable, "-m", "joulepath"]
"""The command line that begins every call of this command."""


def main() -> int:
    """Runs the command with the words of the command line and returns its exit status."""
    # The command has its own way to end, which it takes where nobody else has one.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Fleets go on in the interpreter that was asked.
    os.environ.setdefault("JOULEPATH_PYTHON", sys.executable)
    return _native.command(["joulepath", *sys.argv[1:]], ITSELF)


if __name__ == "__main__":
    sys.exit(main())
