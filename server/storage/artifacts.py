"""Files behind fsspec: checkpoints, renderings, shared archives; each complete or absent."""

import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from uuid import UUID, uuid4

import fsspec
from fsspec.implementations.local import LocalFileSystem

CHUNK = 1 << 20
KEEP_LAST, KEEP_EVERY = 3, 10


@dataclass(frozen=True)
class StoredFile:
    """A file that is completely written."""

    path: str
    size: int
    sha256: str


class Artifacts:
    """A store of files by relative path."""

    def __init__(self, url: str):
        self.files, self.root = fsspec.core.url_to_fs(url)

    def write(self, path: str, data: bytes) -> StoredFile:
        """Write to a temporary file, then rename: after an `OSError` the old file stays.

        On a local disk, file and folder have reached the disk when this returns.
        """
        target = self._full(path)
        temporary = f"{target}.{uuid4().hex}.part"
        self.files.makedirs(self.files._parent(target), exist_ok=True)
        try:
            with self.files.open(temporary, "wb") as file:
                file.write(data)
                file.flush()
                if self.local:
                    os.fsync(file.fileno())
            self._rename(temporary, target)
        except BaseException:
            with suppress(OSError):
                self.files.rm_file(temporary)
            raise
        return StoredFile(path, len(data), hashlib.sha256(data).hexdigest())

    def read(self, path: str) -> bytes:
        return self.files.cat_file(self._full(path))

    def read_verified(self, path: str, sha256: str) -> bytes | None:
        """Return the content, or None if the file is missing or has changed."""
        try:
            data = self.read(path)
        except FileNotFoundError:
            return None
        return data if hashlib.sha256(data).hexdigest() == sha256 else None

    def stream(self, path: str, start: int, stop: int) -> Iterator[bytes]:
        """Yield the bytes from `start` up to `stop` in pieces."""
        with self.files.open(self._full(path), "rb") as file:
            file.seek(start)
            while start < stop and (piece := file.read(min(CHUNK, stop - start))):
                start += len(piece)
                yield piece

    def delete(self, path: str) -> None:
        """Delete a file, or a folder if the path ends with a slash; it may be gone."""
        with suppress(FileNotFoundError):
            if path.endswith("/"):
                self.files.rm(self._full(path), recursive=True)
            else:
                self.files.rm_file(self._full(path))

    def _rename(self, temporary: str, target: str) -> None:
        if not self.local:
            self.files.mv(temporary, target)
            return
        Path(temporary).replace(target)
        folder = os.open(Path(target).parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)

    @property
    def local(self) -> bool:
        return isinstance(self.files, LocalFileSystem)

    def _full(self, path: str) -> str:
        return f"{self.root}/{path}"


def checkpoint_path(run_id: UUID, generation: int, data: bytes) -> str:
    """Return a path with a hash of the content: two attempts never write to one file."""
    name = hashlib.sha256(data).hexdigest()[:16]
    return f"{run_folder(run_id)}{generation:08d}-{name}.h5"


def run_folder(run_id: UUID) -> str:
    """Return the folder of all files of a run, with a slash at its end."""
    return f"runs/{run_id}/"


def rendering_path(creature: str, kind: str) -> str:
    return f"replays/{creature[:2]}/{creature}.{kind}"


def superfluous(numbers: list[int]) -> list[int]:
    """Return a run's checkpoints to delete: all but the last three and every tenth."""
    last = sorted(numbers)[-KEEP_LAST:]
    return [n for n in numbers if n not in last and n % KEEP_EVERY]
