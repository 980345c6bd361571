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
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
