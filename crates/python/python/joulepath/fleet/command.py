"""The `joulepath` command: where it is."""

from __future__ import annotations

import os
import shutil

from .errors import FleetError


def joulepath_command() -> list[str]:
    """Returns the command line that begins every call of the `joulepath` command: that of the variable `JOULEPATH`, or the one on the path.

    Raises a `FleetError` of type `no-command` where there is none.
    """
    named = os.environ.get("JOULEPATH")
    found = shutil.which(named or "joulepath")
    if found is None:
        where = f"JOULEPATH names `{named}`, which is no program" if named else "there is no `joulepath` on the PATH"
        raise FleetError("no-command", f"{where}: install it, or let JOULEPATH name it, on every machine of the cluster")
    return [found]
