"""The data folder: is there room, can it be written to, does it keep what it is told."""

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from .finding import GIB, Finding, gib, ok, problem, warning

LEAST, FEW = GIB, 10 * GIB
SLOW = 1.0
"""Seconds that writing a little for good may take."""
REMOTE = ("nfs", "nfs4", "cifs", "smb3", "fuse.sshfs", "9p")
"""File systems on which SQLite's log does not work."""


def disk(folder: Path, mounts: Path = Path("/proc/mounts")) -> Iterator[Finding]:
    """A folder that is not there yet is judged by the one that it will be made in."""
    there = next(path for path in (folder, *folder.resolve().parents) if path.exists())
    name = f"{folder}" if there == folder else f"{folder} (not there yet; made in {there})"
    free = shutil.disk_usage(there).free
    if free < LEAST:
        advice = "make room, or choose another folder with MICROCOSMOS_DATA"
        yield problem("disk", f"{gib(free)} free at {name}", advice)
    elif free < FEW:
        advice = "long runs keep an archive file each; make room in time"
        yield warning("disk", f"{gib(free)} free at {name}", advice)
    else:
        yield ok("disk", f"{gib(free)} free at {name}")
    yield from _writing(there)
    kind = file_system(there.resolve(), mounts)
    if kind in REMOTE:
        yield warning(
            "disk",
            f"{there} is on a {kind} file system, on which SQLite may lose data",
            "choose a local folder with MICROCOSMOS_DATA, or PostgreSQL with "
            "MICROCOSMOS_DATABASE_URL",
        )


def _writing(folder: Path) -> Iterator[Finding]:
    begun = time.monotonic()
    try:
        with tempfile.NamedTemporaryFile(prefix=".doctor-", dir=folder) as file:
            file.write(bytes(4096))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        advice = f"let it be written to (chown, chmod {folder}), or set MICROCOSMOS_DATA"
        yield problem("disk", f"{folder} cannot be written to: {error.strerror}", advice)
        return
    seconds = time.monotonic() - begun
    told = f"writing for good (fsync) takes {1000 * seconds:.0f} ms"
    if seconds > SLOW:
        yield warning("disk", told, "checkpoints will wait for it; a local disk is faster")
    else:
        yield ok("disk", told)


def file_system(folder: Path, mounts: Path) -> str:
    """The kind of the file system that a folder is on; empty where nobody can say."""
    if not mounts.exists():
        return ""
    entries = [line.split()[1:3] for line in mounts.read_text().splitlines()]
    holding = [
        (place.replace("\\040", " "), kind)
        for place, kind in entries
        if folder.is_relative_to(place.replace("\\040", " "))
    ]
    return max(holding, key=lambda entry: len(entry[0]), default=("", ""))[1]
