"""Files in a folder or in S3: checkpoints, renderings, shared archives; complete or absent."""

import errno
import hashlib
import logging
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar
from uuid import UUID, uuid4

import fsspec
from fsspec.implementations.local import LocalFileSystem

from ..core.errors import FileLost, StoreUnavailable

CHUNK = 4 << 20
ADDRESS = re.compile(r"""["']?\b\w+://[^\s"']+["']?""")
FULL = (errno.ENOSPC, errno.EDQUOT)
"""Errors of a full disk. It stays full until a person acts; a lost mount may come back."""
KEEP_LAST, KEEP_EVERY = 3, 10
S3 = {
    # fsspec shares stores of equal options, and `retries` below is set on one.
    "skip_instance_cache": True,
    "use_listings_cache": False,  # Other machines write, too.
    "config_kwargs": {
        "connect_timeout": 5,
        "read_timeout": 20,
        "retries": {"mode": "standard", "total_max_attempts": 3},
    },
}
"""Options of s3fs. Address and credentials come from the usual variables of AWS."""
S3_TRIES = 2
"""Number of times that s3fs reads an answer which breaks off."""


@dataclass(frozen=True)
class StoredFile:
    """A file that is completely written."""

    path: str
    size: int
    sha256: str


class Artifacts:
    """A store of files by relative path, in a folder or at `s3://bucket/prefix`.

    Raise `FileLost` for a missing file to be read, another `OSError` if a folder's disk is
    full, and `StoreUnavailable` if the store does not answer.
    """

    def __init__(self, url: str):
        self.local = not url.startswith("s3://")
        self.files: Any
        if self.local:  # Not read as a URL: a folder's name may contain `::` or `?`.
            self.files = LocalFileSystem()
            self.root = self.location = str(Path(url).absolute())
        else:
            self.files, self.root = fsspec.core.url_to_fs(url, **S3)
            self.location = f"s3://{self.root}"
            self.files.retries = S3_TRIES

    def write(self, path: str, data: bytes) -> StoredFile:
        """Write a file whole or not at all: after an `OSError` the earlier one stays."""
        try:
            if self.local:
                self._write_to_disk(self._full(path), data)
            else:
                # An object of S3 appears whole or not at all, so it needs no temporary name.
                self.files.pipe_file(self._full(path), data)
        except Exception as error:
            if isinstance(error, OSError) and error.errno in FULL:
                raise
            raise _unavailable(error) from error
        return StoredFile(path, len(data), hashlib.sha256(data).hexdigest())

    def read(self, path: str, start: int | None = None, stop: int | None = None) -> bytes:
        try:
            with _outages():
                return self.files.cat_file(self._full(path), start=start, end=stop)
        except FileNotFoundError:
            raise FileLost(path) from None

    def find(self, path: str) -> bytes | None:
        """Return the content; None if the file is missing."""
        try:
            return self.read(path)
        except FileLost:
            return None

    def read_verified(self, path: str, sha256: str) -> bytes | None:
        """Return the content, or None if the file is missing or has changed."""
        data = self.find(path)
        intact = data is not None and hashlib.sha256(data).hexdigest() == sha256
        return data if intact else None

    def sizes(self, paths: Sequence[str]) -> dict[str, int]:
        """Return the sizes of files of one folder, by path, without those that are missing."""
        found: dict[str, int] = {}
        with _outages():
            if not self.local:  # One listing: asking for each would take seconds.
                folder = self._full(paths[0].rpartition("/")[0]) if paths else ""
                listed = self.files.find(folder, detail=True) if paths else {}
                sizes = {name: one["size"] for name, one in listed.items()}
                return {one: sizes[at] for one in paths if (at := self._full(one)) in sizes}
            for path in paths:
                with suppress(FileNotFoundError):
                    found[path] = Path(self._full(path)).stat().st_size
        return found

    def stream(self, path: str, start: int, stop: int) -> Iterator[bytes]:
        """Return the bytes from `start` up to `stop` in pieces; read the first at once."""
        first = self.read(path, start, min(stop, start + CHUNK)) if start < stop else b""

        def pieces() -> Iterator[bytes]:
            yield first
            for at in range(start + CHUNK, stop, CHUNK):
                yield self.read(path, at, min(stop, at + CHUNK))

        return pieces()

    def delete(self, path: str) -> None:
        """Delete a file, or a folder if the path ends with a slash; it may be gone."""
        with suppress(FileNotFoundError), _outages():
            if not path.endswith("/"):
                self.files.rm_file(self._full(path))
                return
            folder = Path(self._full(path))
            if self.local and folder.is_symlink():
                # A person has moved the folder to another disk: the files are there.
                self.files.rm(str(folder.resolve()), recursive=True)
            self.files.rm(self._full(path), recursive=True)

    def _write_to_disk(self, target: str, data: bytes) -> None:
        """Write beside it, then rename; return when file and folder have reached the disk."""
        temporary = f"{target}.{uuid4().hex}.part"
        self.files.makedirs(self.files._parent(target), exist_ok=True)
        try:
            with self.files.open(temporary, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            Path(temporary).replace(target)
        except BaseException:
            with suppress(OSError):
                self.files.rm_file(temporary)
            raise
        # The new name is on the disk once its folder is (fsync(2)).
        folder = os.open(Path(target).parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)

    def _full(self, path: str) -> str:
        return f"{self.root}/{path}"


@contextmanager
def _outages() -> Iterator[None]:
    """Raise `StoreUnavailable` for all errors of a store but that of a missing file."""
    try:
        yield
    except (FileNotFoundError, StoreUnavailable):
        raise
    except Exception as error:
        raise _unavailable(error) from error


def reason(error: Exception) -> str:
    """Return what went wrong, without the path in it: people who may only read see it."""
    return getattr(error, "strerror", None) or ADDRESS.sub("the store", str(error))


def _unavailable(error: Exception) -> StoreUnavailable:
    """Return the outage behind an error: libraries of S3 have errors of their own."""
    return StoreUnavailable(f"{type(error).__name__}: {reason(error)}")


def checkpoint_path(run_id: UUID, attempt: int, generation: int, data: bytes) -> str:
    """Return a path that is used once: no two attempts ever write to one file."""
    name = hashlib.sha256(data).hexdigest()[:16]
    return f"{run_folder(run_id)}{generation:08d}-{attempt}-{name}.h5"


def run_folder(run_id: UUID) -> str:
    """Return the folder of all files of a run, with a slash at its end."""
    return f"runs/{run_id}/"


def rendering_path(creature: str, kind: str) -> str:
    """Return a path that is used once, so that deleting an earlier rendering hits no other."""
    return f"replays/{creature[:2]}/{creature}-{uuid4().hex[:8]}.{kind}"


def superfluous(numbers: list[int]) -> list[int]:
    """Return a run's checkpoints to delete: all but the last three and every tenth."""
    last = sorted(numbers)[-KEEP_LAST:]
    return [n for n in numbers if n not in last and n % KEEP_EVERY]


FIRST_PAUSE, LONGEST_PAUSE = 0.2, 10.0

T = TypeVar("T")
log = logging.getLogger(__name__)


def patiently(action: Callable[[], T], seconds: float, stopped: Callable[[], bool]) -> T:
    """Return the result of an action; retry outages for some seconds, or until `stopped`."""
    deadline, pause = time.monotonic() + seconds, FIRST_PAUSE
    while True:
        try:
            return action()
        except StoreUnavailable as error:
            if time.monotonic() + pause > deadline or stopped():
                raise
            log.warning("Waiting for the store: %s", error)
        time.sleep(pause)
        pause = min(2 * pause, LONGEST_PAUSE)
