"""Storage of a fleet's results: a folder, or a bucket that speaks S3, with the layout of the service's own store.

Reports lie where the service keeps those of its jobs (`reports/ID.json`, or `tenants/NAME/reports/ID.json`), so that its page shows them.
What only a fleet needs lies under `fleet/`.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import posixpath
import shutil
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .._optional import needed
from .errors import FleetError

ID_CHARACTERS = 32
"""Length of an id: the first 128 bits of a SHA-256, as the service's ids."""
PIECE_BYTES = 1 << 20
"""What is read of a recording at a time."""


class Storage:
    """Objects by name. An object is there as a whole or not at all."""

    def __init__(self, place: str | os.PathLike[str], tenant: str = "default") -> None:
        """Opens a folder, which is made, or `s3://BUCKET/PREFIX`, whose access stands in the `AWS_...` variables."""
        self.place = os.fspath(place)
        self.tenant = tenant
        if not tenant or not all(c.isascii() and (c.isalnum() or c in "-_") for c in tenant):
            raise FleetError("invalid-request", f"tenant {tenant!r}: give a tenant's name of letters, digits, `-` and `_`")
        self._files, self._root = _opened(self.place)
        self._is_local = "://" not in self.place

    def report_name(self, id: str) -> str:
        """The name of a job's report."""
        return f"reports/{id}.json" if self.tenant == "default" else f"tenants/{self.tenant}/reports/{id}.json"

    def read(self, name: str) -> Any | None:
        """Returns the document of a name, or none where there is none."""
        try:
            with self._files.open_input_stream(self._path(name)) as stream:
                return json.loads(stream.readall())
        except FileNotFoundError:
            return None
        except ValueError as error:
            raise FleetError("store-unavailable", f"{self.place}: {name} is no JSON document: remove it") from error

    def has(self, name: str) -> bool:
        """Whether there is an object of a name."""
        from pyarrow.fs import FileType

        return self._files.get_file_info(self._path(name)).type == FileType.File

    def write(self, name: str, document: Any) -> None:
        """Writes a document, in place of what was there."""
        data = json.dumps(document, allow_nan=False, separators=(",", ":")).encode()
        path = self._path(name)
        if not self._is_local:
            with self._files.open_output_stream(path) as stream:
                stream.write(data)
            return
        os.makedirs(os.path.dirname(path), exist_ok=True)
        # The service sweeps away what has a `#` in its name and was left by who was killed.
        beside = f"{path}#{uuid.uuid4().hex}"
        with open(beside, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)

    def names(self, folder: str) -> list[str]:
        """Returns the names of all objects in a folder, in their order."""
        from pyarrow.fs import FileSelector, FileType

        selector = FileSelector(self._path(folder), allow_not_found=True)
        files = [entry for entry in self._files.get_file_info(selector) if entry.type == FileType.File and "#" not in entry.base_name]
        return sorted(f"{folder}/{entry.base_name}" for entry in files)

    def _path(self, name: str) -> str:
        return posixpath.join(self._root, name)


def id_of(document: Any) -> str:
    """Returns the id of a document: the hash of its JSON with sorted names."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:ID_CHARACTERS]


@contextlib.contextmanager
def local_copy(path: str) -> Iterator[Path]:
    """Gives a recording as a file or folder of this machine: itself, or a copy that is gone afterwards."""
    if "://" not in path:
        yield Path(path)
        return
    files, name = _opened(path, make=False)
    with tempfile.TemporaryDirectory(prefix="joulepath-fleet-") as room:
        copy = Path(room, posixpath.basename(name))
        with files.open_input_stream(name) as source, open(copy, "wb") as target:
            shutil.copyfileobj(source, target, PIECE_BYTES)
        yield copy


def content_id(path: Path) -> str:
    """Returns the id that the service gives a recording's file; of a folder, that of all its files with their names."""
    whole = hashlib.sha256()
    files = [path] if path.is_file() else sorted(file for file in path.rglob("*") if file.is_file())
    if not files:
        raise FileNotFoundError(2, "No such file or directory", str(path))
    for file in files:
        if file is not path:
            whole.update(f"{file.relative_to(path).as_posix()}\0{file.stat().st_size}\0".encode())
        with open(file, "rb") as source:
            while piece := source.read(PIECE_BYTES):
                whole.update(piece)
    return whole.hexdigest()[:ID_CHARACTERS]


def files_below(place: str, endings: tuple[str, ...]) -> list[str]:
    """Returns the addresses of all objects below an `s3://` address whose names end so."""
    from pyarrow.fs import FileSelector, FileType

    files, root = _opened(place, make=False)
    scheme = place.split("://", 1)[0]
    entries = files.get_file_info(FileSelector(root, recursive=True, allow_not_found=True))
    return sorted(f"{scheme}://{entry.path}" for entry in entries if entry.type == FileType.File and entry.path.endswith(endings))


def _opened(place: str, make: bool = True) -> tuple[Any, str]:
    fs = needed("pyarrow.fs")
    if "://" not in place:
        root = os.path.abspath(place)
        if make:
            try:
                os.makedirs(root, exist_ok=True)
            except OSError as error:
                raise FleetError("store-unavailable", f"storage {place}: {error.strerror}; give a folder that can be written to") from error
        return fs.LocalFileSystem(), root
    if not place.startswith("s3://"):
        raise FleetError("invalid-request", f"storage {place}: give a folder or s3://BUCKET/PREFIX")
    return fs.S3FileSystem(**_endpoint()), place.removeprefix("s3://").rstrip("/")


def _endpoint() -> dict[str, str]:
    """Where a bucket is that is not at Amazon, as the service reads it from the same variable."""
    address = os.environ.get("AWS_ENDPOINT_URL", "")
    scheme, _, host = address.partition("://")
    return {"scheme": scheme, "endpoint_override": host.rstrip("/")} if host else {}
