"""Tables without files: the recording that their file is."""

from __future__ import annotations

import numpy
import pytest

import joulepath


def same(one: joulepath.Recording, other: joulepath.Recording) -> bool:
    names = (one.channels, one.aside, list(one.runs))
    return names == (other.channels, other.aside, list(other.runs)) and all(
        numpy.array_equal(one[name], other[name], equal_nan=True) for name in ["t_s", *one.channels, *one.aside]
    )


@pytest.fixture(scope="module")
def frame(drive):
    import pandas

    frame = pandas.DataFrame({name: column.round(6) for name, column in drive.items()})
    frame.loc[5, "power_w"] = numpy.nan
    frame["run"] = numpy.where(frame["t_s"] < 60, "there", "back")
    frame["surface"] = "marble"
    frame["gear"] = 2
    return frame


def test_pandas_arrow_polars_and_files_are_one_recording(frame, tmp_path):
    import polars
    import pyarrow

    frame.to_csv(tmp_path / "drive.csv", index=False)
    frame.to_parquet(tmp_path / "drive.parquet", index=False)
    file = joulepath.Recording.open(tmp_path / "drive.csv")
    assert list(file.runs) == ["there", "back"] and file.aside == ["gear"] and file["surface"][3] == "marble"
    assert same(joulepath.Recording.open(tmp_path / "drive.parquet"), file)
    assert same(joulepath.Recording.from_pandas(frame), file)
    assert same(joulepath.Recording.from_pandas(frame.astype({"run": "category", "gear": "Int64"})), file)
    assert same(joulepath.Recording.from_arrow(pyarrow.Table.from_pandas(frame, preserve_index=False)), file)
    assert same(joulepath.Recording.from_arrow(polars.from_pandas(frame)), file)
    assert same(joulepath.Recording.from_columns({name: frame[name].to_numpy() for name in frame}), file)
    assert same(joulepath.Recording.from_pandas(file.to_pandas()), file)


def test_arrow_in_pieces_with_dictionaries_and_small_types_is_the_same(frame):
    import pyarrow

    table = pyarrow.Table.from_pandas(frame, preserve_index=False)
    pieces = pyarrow.concat_tables([table.slice(0, 100), table.slice(100, 1), table.slice(101)])
    whole = joulepath.Recording.from_arrow(table)
    assert same(joulepath.Recording.from_arrow(pieces), whole)
    names = pieces.column("run").dictionary_encode()
    gears = pieces.column("gear").cast(pyarrow.uint8())
    other = pieces.set_column(pieces.column_names.index("run"), "run", names)
    other = other.set_column(other.column_names.index("gear"), "gear", gears)
    assert same(joulepath.Recording.from_arrow(other), whole)


def test_times_of_the_calendar_are_seconds(frame):
    import pandas
    import pyarrow

    start = pandas.Timestamp("2026-05-01T10:00:00Z")
    stamped = frame.assign(t_s=start + pandas.to_timedelta(frame["t_s"].mul(1e9).round().astype("int64"), unit="ns"))
    aware = joulepath.Recording.from_pandas(stamped)
    naive = joulepath.Recording.from_pandas(stamped.assign(t_s=stamped["t_s"].dt.tz_localize(None)))
    arrow = joulepath.Recording.from_arrow(pyarrow.Table.from_pandas(stamped, preserve_index=False))
    for recording in (aware, naive, arrow):
        numpy.testing.assert_allclose(numpy.diff(recording["t_s"]), 0.1, atol=1e-4)


def test_columns_may_be_named_by_a_map_as_those_of_files(frame, tmp_path):
    renamed = frame.rename(columns={"power_w": "P_kW"}).assign(P_kW=frame["power_w"] / 1000)
    columns = {"name": "lab", "sources": [{"channel": "power_w", "column": "P_kW", "unit": "kW"}]}
    recording = joulepath.Recording.from_pandas(renamed, columns=columns)
    numpy.testing.assert_allclose(recording["power_w"][6:], frame["power_w"][6:])
    renamed.to_parquet(tmp_path / "drive.parquet", index=False)
    assert same(recording, joulepath.Recording.open(tmp_path / "drive.parquet", columns=columns))


def test_what_is_suspicious_warns(drive):
    with pytest.warns(joulepath.RecordingWarning):
        joulepath.Recording.from_columns({**drive, "pitch_rad": 20.0 * numpy.sin(drive["t_s"])})
