"""What cannot be is refused by an exception of its own, which names the place and how to mend it."""

from __future__ import annotations

import pickle

import numpy
import pytest

import joulepath
from joulepath import errors

FLAT = numpy.zeros((10, 12))


def refused(kind, call, *said, pointer=None):
    """The failure of a call: of exactly this class, with these words, and at this place."""
    with pytest.raises(errors.Error) as caught:
        call()
    error = caught.value
    assert type(error) is kind, repr(error)
    for words in said:
        assert words in error.detail, error.detail
    if pointer is not None:
        assert error.pointer == pointer
    assert error.to_dict()["type"] == error.type and error.title and error.status
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is kind and again.to_dict() == error.to_dict()
    return error


def drive(**other):
    t_s = numpy.arange(0.0, 30.0, 0.1)
    columns = {"t_s": t_s, "v_left_mps": 0.5 + 0 * t_s, "v_right_mps": 0.5 + 0 * t_s, "power_w": 80 + 0 * t_s}
    return {**columns, **other}


def test_arrays_of_the_wrong_shape():
    of = joulepath.Map.from_array
    refused(errors.ShapeError, lambda: of(numpy.zeros(5), 1.0), "1 axis", "reshape", pointer="/z")
    refused(errors.ShapeError, lambda: of(numpy.zeros((2, 3, 4)), 1.0), "3 axes", pointer="/z")
    refused(errors.ShapeError, lambda: of(FLAT, 1.0, obstacle=numpy.zeros((10, 11), bool)), "(10, 11)", pointer="/obstacle")
    refused(errors.ShapeError, lambda: of(FLAT, 1.0, surface=numpy.full((12, 10), "grass")), "(12, 10)", pointer="/surface")
    power = joulepath.power
    refused(errors.ShapeError, lambda: power("jackal", numpy.zeros(3), numpy.zeros(4)), "speed_mps (3,)", "yaw_rate_radps (4,)")
    refused(errors.RaggedColumnsError, lambda: joulepath.Recording.from_columns(drive(power_w=numpy.zeros(7))), "7 rows", "300")
    refused(errors.RaggedColumnsError, lambda: joulepath.Recording.from_columns(drive(power_w=numpy.zeros((300, 2)))), "(300, 2)")


def test_units_that_cannot_be():
    pitch_rad = numpy.array([0.1, 20.0])
    error = refused(errors.UnitError, lambda: joulepath.power("jackal", 0.5, pitch_rad=pitch_rad), "pitch_rad[1] is 20", "radians")
    assert error.pointer == "/pitch_rad"
    refused(errors.UnitError, lambda: joulepath.power("jackal", 0.5, motor_temp_left_c=-300.0), "-273.15")
    milliseconds = drive(t_s=numpy.arange(0.0, 30_000.0, 100.0))
    refused(errors.UnitError, lambda: joulepath.Recording.from_columns(milliseconds), "must be in seconds", pointer="/t_s")
    refused(errors.InvalidMapError, lambda: joulepath.Map.from_array(FLAT, 0.0), "cell_size_m", pointer="/cell_size_m")
    refused(errors.InvalidMapError, lambda: joulepath.Map.from_array(FLAT + 5e4, 1.0), "50000")


def test_masked_arrays_and_nan():
    masked = numpy.ma.masked_less(FLAT, -1.0)
    refused(errors.MaskedArrayError, lambda: joulepath.Map.from_array(masked, 1.0), "z.filled(numpy.nan)", pointer="/z")
    refused(errors.MaskedArrayError, lambda: joulepath.power("jackal", masked), "speed_mps.compressed()", pointer="/speed_mps")
    column = numpy.ma.masked_invalid(numpy.ones(300))
    refused(errors.MaskedArrayError, lambda: joulepath.Recording.from_columns(drive(power_w=column)), "NaN is a gap", pointer="/power_w")
    holed = FLAT.copy()
    holed[3, 4] = numpy.nan
    refused(
        errors.NotANumberError, lambda: joulepath.Map.from_array(holed, 1.0), "z[3, 4] is nan", 'unknown="impassable"', pointer="/z/3/4"
    )
    assert numpy.isnan(joulepath.Map.from_array(holed, 1.0, unknown="impassable").elevation_m[3, 4])
    holed[3, 4] = numpy.inf
    refused(errors.NotANumberError, lambda: joulepath.Map.from_array(holed, 1.0, unknown="impassable"), "z[3, 4] is inf")
    speeds_mps = numpy.array([0.5, numpy.nan])
    refused(errors.NotANumberError, lambda: joulepath.power("jackal", speeds_mps), "speed_mps[1] is NaN", pointer="/speed_mps")
    infinite = numpy.ones(300)
    infinite[2] = numpy.inf
    refused(errors.NotANumberError, lambda: joulepath.Recording.from_columns(drive(power_w=infinite)), "row 3", pointer="/power_w")
    planner = joulepath.Planner(joulepath.Map.from_array(FLAT, 1.0))
    refused(errors.NotANumberError, lambda: planner.plan((1, numpy.nan), (5, 5)), "start.y_m is nan", pointer="/start/y_m")


def test_time_that_does_not_increase():
    t_s = drive()["t_s"]
    back = t_s.copy()
    back[7] = back[5]
    refused(errors.TimeOrderError, lambda: joulepath.Recording.from_columns(drive(t_s=back)), "row 8", "sort the rows", pointer="/t_s")


def test_columns_of_objects():
    import decimal

    import pandas
    import pyarrow

    table = pandas.DataFrame(drive())
    watts = table.assign(power_w=[decimal.Decimal(80)] * len(table))
    refused(errors.ColumnTypeError, lambda: joulepath.Recording.from_pandas(watts), "Decimal in row 1", "astype(float)", pointer="/power_w")
    text = table.assign(power_w=["80 W"] * len(table))
    refused(errors.ColumnTypeError, lambda: joulepath.Recording.from_pandas(text), "it holds text", pointer="/power_w")
    lists = pyarrow.table({**drive(), "power_w": [[80.0]] * len(table)})
    refused(errors.ColumnTypeError, lambda: joulepath.Recording.from_arrow(lists), "it holds", pointer="/power_w")
    unused = joulepath.Recording.from_pandas(table.assign(note=[object()] * len(table)))
    assert unused.aside == [] and "note" in str(unused.reports)
    refused(errors.InvalidMapError, lambda: joulepath.Map.from_array(FLAT.astype(object), 1.0), "object", pointer="/z")


def test_a_crs_that_the_map_lacks():
    planner = joulepath.Planner(joulepath.Map.from_array(FLAT, 1.0))
    path = planner.plan((2, 2, 0), (9, 6))
    refused(errors.MissingCrsError, path.to_geodataframe, "crs='EPSG:32632'", pointer="/map/crs")
    assert path.to_geodataframe(crs="EPSG:32632").crs == "EPSG:32632"
    refused(errors.MissingCrsError, planner.reachable((5, 5), energies_j=[200.0]).to_geodataframe)
    refused(errors.InvalidMapError, lambda: joulepath.Map.from_array(FLAT, 1.0, crs="EPSG:4326"), pointer="/crs")
    degrees = {"lon_deg": 9.0, "lat_deg": 47.0}
    refused(errors.InvalidRequestError, lambda: planner.plan(degrees, (5, 5)), "crs")


def test_arguments_are_refused_as_the_service_refuses_them():
    planner = joulepath.Planner(joulepath.Map.from_array(FLAT, 1.0))
    refused(errors.StartOutsideMapError, lambda: planner.plan((-5, 2), (9, 6)), pointer="/start")
    refused(errors.GoalOutsideMapError, lambda: planner.plan((2, 2), (99, 6)), pointer="/goal")
    refused(errors.InvalidRequestError, lambda: planner.plan((2, 2), (9, 6), bound=0.5), "bound", pointer="/bound")
    refused(errors.InvalidRequestError, lambda: planner.plan((2, 2), (9, 6), objectiv="time"), "objectiv")
    refused(errors.InvalidRequestError, lambda: planner.plan((2, 2), (9, 6), areas=object()), "areas is a object", pointer="/areas")
    refused(errors.InvalidRequestError, lambda: planner.plan("here", (9, 6)), "start is 'here'", pointer="/start")
    refused(errors.UnknownRobotError, lambda: joulepath.Planner(planner.map, "huskey"), "husky-a200")
    refused(errors.InvalidRobotError, lambda: joulepath.Robot.builtin().replace(mass_kg=-1.0), "mass_kg", pointer="/mass_kg")
    refused(errors.InvalidRobotError, lambda: joulepath.Robot.builtin().replace(mas_kg=1.0), "mas_kg")
    grass = joulepath.Map.from_array(FLAT, 1.0, surface=numpy.full(FLAT.shape, "lava"))
    refused(errors.UnknownSurfaceError, lambda: joulepath.Planner(grass).plan((2, 2), (9, 6)), "lava")
    refused(errors.UnknownSurfaceError, lambda: joulepath.power("jackal", 0.5, surface="lava"), "lava", pointer="/surface")
    refused(errors.InvalidRequestError, lambda: joulepath.power("jackal", 0.5, power_model="magic"), pointer="/power_model")
    wall = numpy.zeros(FLAT.shape, bool)
    wall[:, 5] = True
    walled = joulepath.Planner(joulepath.Map.from_array(FLAT, 1.0, obstacle=wall))
    refused(errors.NoPathError, lambda: walled.plan((2, 5), (9, 5)))
    refused(errors.StartBlockedError, lambda: walled.plan((5.5, 5), (9, 5), snap_radius_m=0.0), pointer="/start")


def test_recordings_that_do_not_suffice():
    short = {name: column[:20] for name, column in drive().items()}
    refused(errors.InsufficientRecordingError, lambda: joulepath.diagnose(short))
    refused(errors.InvalidRecordingError, lambda: joulepath.predict({"t_s": numpy.arange(9.0)}), "v_left_mps")
    refused(errors.InvalidRequestError, lambda: joulepath.predict([]), "at least one path", pointer="/recordings")
    refused(errors.InvalidRequestError, lambda: joulepath.predict(7), "a int is no recording")
    refused(errors.InvalidRequestError, lambda: joulepath.diagnose(drive(), ruled_out=["magic"]), pointer="/ruled_out/0")


def test_a_package_that_is_not_there(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "xarray", None)
    refused(errors.NotInstalledError, joulepath.Map.from_array(FLAT, 1.0).to_xarray, "pip install 'joulepath[maps]'")
