"""joulepath: energy-minimal paths for skid-steered robots, and what they will cost.

SI units everywhere: every argument, field and column that carries a quantity ends in its unit (``_m``, ``_rad``, ``_mps``, ``_w``, ``_j``,
``_s``, ``_c``). x is east, y is north; headings count counter-clockwise from east, pitch is positive climbing, power is positive when
drawn from the battery.

>>> import joulepath, numpy
>>> yard = joulepath.Map.from_array(numpy.zeros((40, 60)), cell_size_m=0.5)
>>> path = joulepath.Planner(yard, "husky-a200").plan((2, 10, 0), (20, 10))
>>> round(path.distance_m)
18
"""

from . import errors
from ._answers import Columns
from ._diagnosis import Calibration, Diagnosis, Prediction, Simulation, calibrate, diagnose, predict, simulate
from ._map import Map
from ._path import Alternatives, Comparison, Matrix, Mission, Path, Range, Reachable
from ._planner import Planner
from ._power import power
from ._recording import Recording, RecordingWarning
from ._robot import Robot
from .errors import Error

__all__ = [
    "Alternatives",
    "Calibration",
    "Columns",
    "Comparison",
    "Diagnosis",
    "Error",
    "Map",
    "Matrix",
    "Mission",
    "Path",
    "Planner",
    "Prediction",
    "Range",
    "Reachable",
    "Recording",
    "RecordingWarning",
    "Robot",
    "Simulation",
    "calibrate",
    "diagnose",
    "errors",
    "power",
    "predict",
    "simulate",
]
