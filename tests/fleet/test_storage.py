"""What is kept, and under which names."""

import hashlib

import pytest
from joulepath.fleet import FleetError, Storage
from joulepath.fleet.storage import content_id, id_of


def test_a_recording_has_the_id_that_the_service_gives_it(tmp_path):
    (tmp_path / "x.csv").write_bytes(b"t_s\n1\n")
    assert content_id(tmp_path / "x.csv") == hashlib.sha256(b"t_s\n1\n").hexdigest()[:32]


def test_a_folders_id_is_that_of_all_its_files_and_their_names(tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "0.db3").write_text("a")
    before = content_id(tmp_path / "bag")
    (tmp_path / "bag" / "0.db3").rename(tmp_path / "bag" / "1.db3")
    assert content_id(tmp_path / "bag") != before


def test_an_id_depends_on_content_and_not_on_the_order_of_names():
    assert id_of({"a": 1, "b": 2}) == id_of({"b": 2, "a": 1}) != id_of({"a": 1, "b": 3})
    with pytest.raises(ValueError):
        id_of({"a": float("nan")})


def test_a_document_is_there_as_a_whole_and_half_written_ones_are_nobodys(tmp_path):
    storage = Storage(tmp_path)
    storage.write("reports/0f.json", {"a": [1, 2]})
    (tmp_path / "reports" / "1e.json#5").write_text("{")
    assert storage.names("reports") == ["reports/0f.json"]
    assert storage.read("reports/0f.json") == {"a": [1, 2]}
    assert storage.read("reports/1e.json") is None


def test_reports_of_a_tenant_lie_where_the_service_looks_for_them(tmp_path):
    assert Storage(tmp_path).report_name("0f") == "reports/0f.json"
    assert Storage(tmp_path, "alice").report_name("0f") == "tenants/alice/reports/0f.json"
    with pytest.raises(FleetError, match="tenant"):
        Storage(tmp_path, "../alice")


def test_a_place_that_cannot_be_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FleetError, match="give a folder that can be written to"):
        Storage(tmp_path / "file")
    with pytest.raises(FleetError, match="give a folder or s3://BUCKET/PREFIX"):
        Storage("gs://bucket/x")
