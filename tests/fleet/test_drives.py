"""Which drives are meant, and what is refused."""

import pytest
from joulepath.fleet import Drive, FleetError, read_list
from joulepath.fleet.drives import date_in, drives_of


@pytest.mark.parametrize(
    ("name", "date"),
    [
        ("2026-03-02.csv", "2026-03-02"),
        ("rosbag2_2026_03_02-10_11_12", "2026-03-02"),
        ("log20260302.mcap", "2026-03-02"),
        ("2026-13-40.csv", None),
        ("run1234567890.csv", None),
        ("drive.csv", None),
    ],
)
def test_a_date_is_taken_from_a_name_only_where_one_stands_there(name, date):
    assert date_in(name) == date


def test_folders_are_units_and_hold_their_recordings_in_the_order_of_names(tmp_path):
    for name in ("b/2026-03-09.csv", "b/2026-03-02.csv", "a/x.mcap", "a/notes.txt", "a/.part-1/y.csv", "a/bag/metadata.yaml", "a/bag/0.db3"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    found = [(drive.unit, drive.path.removeprefix(f"{tmp_path}/"), drive.date) for drive in drives_of(tmp_path)]
    assert found == [("a", "a/bag", None), ("a", "a/x.mcap", None), ("b", "b/2026-03-02.csv", "2026-03-02"), ("b", "b/2026-03-09.csv", "2026-03-09")]


def test_a_list_names_units_and_dates_and_its_paths_count_from_it(tmp_path):
    (tmp_path / "fleet.csv").write_text("path,unit,date\nx.csv,husky-1,2026-03-02\ns3://logs/y.csv,husky-2,\n")
    assert read_list(tmp_path / "fleet.csv") == [
        Drive(str(tmp_path / "x.csv"), "husky-1", "2026-03-02"),
        Drive("s3://logs/y.csv", "husky-2", None),
    ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("path,unit\n,husky-1\n", "row 1: it needs a path and a unit"),
        ("path,unit,day\nx.csv,husky-1,2026-03-02\n", "unknown column `day`; known: path, unit, date"),
        ("path,unit,date\nx.csv,husky-1,March\n", "'March' is not a day as 2026-03-02"),
        ("path,unit,date\n", "names no drive"),
        ("", "names no drive"),
    ],
)
def test_a_list_that_is_wrong_is_refused_with_the_place(tmp_path, text, says):
    (tmp_path / "fleet.csv").write_text(text)
    with pytest.raises(FleetError, match=says):
        read_list(tmp_path / "fleet.csv")


def test_a_recording_that_is_named_twice_is_refused(tmp_path):
    with pytest.raises(FleetError, match="named twice"):
        drives_of([Drive("x/a.csv", "x"), "x/a.csv"])


def test_a_folder_or_pattern_without_recordings_is_refused(tmp_path):
    for wrong in (tmp_path, f"{tmp_path}/*.mcap"):
        with pytest.raises(FleetError, match="holds no recording"):
            drives_of(wrong)
