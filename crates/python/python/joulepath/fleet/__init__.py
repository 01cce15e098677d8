"""Fleets: the same question to thousands of recordings, spread over machines by Ray, and what the answers say of the robots.

    from joulepath import fleet

    run = fleet.calibrate("logs/*/*.mcap", robot="husky-a200", storage="s3://fleet/results")
    print(run)                                      # how many were done, which failed and why
    report = fleet.report(storage="s3://fleet/results")
    report.write("fleet-report")                    # report.json, units.csv, parameters.csv, report.html

Results are kept by the hash of all that they depend on, where the service keeps its own: `joulepath serve --store` shows them. A run whose
driver died is taken up by asking again.
"""

from .._optional import needed

needed("scipy")

from .ask import calibrate, diagnose, report
from .cluster import Ways
from .drives import Drive, read_list
from .errors import FleetError
from .matrix import FleetMatrix, matrix
from .prove import prove
from .report import FleetReport
from .run import Counts, Run
from .storage import Storage

__all__ = [
    "Counts",
    "Drive",
    "FleetError",
    "FleetMatrix",
    "FleetReport",
    "Run",
    "Storage",
    "Ways",
    "calibrate",
    "diagnose",
    "matrix",
    "prove",
    "read_list",
    "report",
]
