"""Atomic writing of files: write beside, sync, rename, sync the folder."""

import os
from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """Replace a file; the old content stays readable on any failure. Raises `OSError`."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with beside.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(path: Path) -> None:
    """Write the folder's entries to disk, so that a rename in it survives a crash."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
