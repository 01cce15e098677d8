"""A bucket that speaks S3 as the storage and as the place of the recordings."""

import os
import socket
import subprocess
import time

import pytest
from joulepath import fleet
from joulepath.fleet.drives import drives_of
from joulepath.fleet.storage import content_id, local_copy

START_TIME_S = 60.0


@pytest.fixture
def bucket(monkeypatch):
    """A bucket of a server on the loopback."""
    python = os.environ.get("JOULEPATH_PYTHON")
    if python is None or subprocess.run([python, "-c", "import moto.server"], capture_output=True).returncode:
        pytest.skip("JOULEPATH_PYTHON names no interpreter that has moto, which serves a bucket")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen([python, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)], stderr=subprocess.DEVNULL)
    try:
        end_s = time.monotonic() + START_TIME_S
        while socket.socket().connect_ex(("127.0.0.1", port)):
            assert time.monotonic() < end_s and server.poll() is None
            time.sleep(0.1)
        for name, value in (("AWS_ENDPOINT_URL", f"http://127.0.0.1:{port}"), ("AWS_ACCESS_KEY_ID", "of a test"), ("AWS_SECRET_ACCESS_KEY", "of a test")):
            monkeypatch.setenv(name, value)
        monkeypatch.setenv("AWS_REGION", "us-east-1")
        subprocess.run(
            [python, "-c", "import boto3, os; boto3.client('s3', endpoint_url=os.environ['AWS_ENDPOINT_URL'], region_name='us-east-1').create_bucket(Bucket='fleet')"],
            check=True,
        )
        yield "s3://fleet"
    finally:
        server.terminate()
        server.wait(timeout=20)


def test_documents_and_recordings_lie_in_a_bucket_as_in_a_folder(bucket, tmp_path):
    storage = fleet.Storage(f"{bucket}/results")
    assert storage.read("reports/0f.json") is None and storage.names("reports") == []
    storage.write("reports/0f.json", {"a": 1})
    assert storage.read("reports/0f.json") == {"a": 1} and storage.has("reports/0f.json")
    assert storage.names("reports") == ["reports/0f.json"]

    from pyarrow import fs

    files = fs.S3FileSystem(scheme="http", endpoint_override=os.environ["AWS_ENDPOINT_URL"].removeprefix("http://"))
    with files.open_output_stream("fleet/logs/husky-1/2026-03-02.csv") as stream:
        stream.write(b"t_s\n1\n")
    [drive] = drives_of(f"{bucket}/logs")
    assert (drive.unit, drive.date) == ("husky-1", "2026-03-02")
    (tmp_path / "same.csv").write_bytes(b"t_s\n1\n")
    with local_copy(drive.path) as copy:
        assert content_id(copy) == content_id(tmp_path / "same.csv")
    assert not copy.exists()


def test_a_recording_that_is_not_in_the_bucket_is_missing_by_name(bucket):
    with pytest.raises(FileNotFoundError), local_copy(f"{bucket}/logs/none.csv"):
        pass
