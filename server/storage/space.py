"""Free space on the disks of an installation, and a warning before there is none."""

import shutil
from collections.abc import Iterator
from pathlib import Path

from microcosmos.sizes import size

from ..settings import Settings
from .artifacts import Artifacts

FULL_BYTES = 64 << 20
"""Free bytes below which a disk counts as full: neither runs nor their rows may fit."""


def folders(settings: Settings, artifacts: Artifacts) -> Iterator[Path]:
    """Yield the folders that the installation fills on disks of this machine."""
    if artifacts.local:
        yield Path(artifacts.root)
    if settings.database.startswith("sqlite"):
        yield settings.data.resolve()


def free_bytes(folder: Path) -> int:
    """Return the free bytes where a folder is, or will be."""
    there = next(one for one in (folder, *folder.parents) if one.exists())
    return shutil.disk_usage(there).free


def shortage(settings: Settings, artifacts: Artifacts) -> str | None:
    """Return a warning about the fullest disk; None while all have enough space."""
    free = {folder: free_bytes(folder) for folder in folders(settings, artifacts)}
    if not free or min(free.values()) >= settings.min_free_bytes:
        return None
    folder = min(free, key=lambda one: free[one])
    return (
        f"The disk of {folder} has {size(free[folder])} left. When it is full, runs keep their "
        "last checkpoint and lose what they compute after it"
    )


def is_full(settings: Settings, artifacts: Artifacts) -> bool:
    return any(free_bytes(one) < FULL_BYTES for one in folders(settings, artifacts))
