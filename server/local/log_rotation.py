"""Rotation of the logs that `make run` writes: copy a long one, and empty it.

Its processes hold their logs open and append to them, Redis too, so a log keeps its name.
"""

import os
import shutil
from pathlib import Path

OLDER_PARTS = 4
"""Number of older parts of each log: `server.log.1` is the newest."""


def rotate(folder: Path, limit: int) -> None:
    """Rotate the logs in a folder that are longer than `limit` bytes."""
    for log in sorted(folder.glob("*.log")):
        if log.stat().st_size > limit:
            _rotate(log)


def _rotate(log: Path) -> None:
    parts = [log.with_name(f"{log.name}.{number}") for number in range(1, OLDER_PARTS + 1)]
    for older, newer in zip(reversed(parts), reversed(parts[:-1]), strict=False):
        if newer.exists():
            newer.replace(older)
    shutil.copyfile(log, parts[0])
    os.truncate(log, 0)
