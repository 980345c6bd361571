"""Atomic writing of files: write beside, sync, rename, sync the folder."""

import fcntl
import os
import re
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """Replace a file; the old content stays readable on any failure. Raises `OSError`.

    Parts that killed processes left beside this file are removed.
    """
    if path.is_dir():
        raise IsADirectoryError(f"a file is needed, got the folder {path}")
    _remove_left(path)
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with beside.open("wb") as file:
            with suppress(OSError):  # Some file systems have no locks.
                fcntl.flock(file, fcntl.LOCK_EX)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
            beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def _remove_left(path: Path) -> None:
    """Remove parts of a file that nobody writes any more.

    A writer locks its part while it is empty, and a lock ends with its process: a part with
    content and without a lock has lost its writer.
    """
    name = re.compile(rf"\.{re.escape(path.name)}\.\d+\.part")
    for part in filter(lambda found: name.fullmatch(found.name), path.parent.iterdir()):
        with suppress(OSError), part.open("rb+") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # Fails while one is writing.
            if os.fstat(file.fileno()).st_size:
                part.unlink()


def sync_folder(path: Path) -> None:
    """Write the folder's entries to disk, so that a rename in it survives a crash."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
