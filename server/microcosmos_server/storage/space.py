"""Free space on the disks of an installation, and a warning before there is none."""

import shutil
from pathlib import Path

from microcosmos.sizes import size

from ..settings import Settings, existing
from .artifacts import Artifacts

FULL_BYTES = 64 << 20
"""Free bytes below which a disk counts as full: neither runs nor their rows may fit."""


def folders(settings: Settings, artifacts: Artifacts) -> dict[str, Path]:
    """Return the folders that the installation fills on disks of this machine, by their use."""
    found = {"store": Path(artifacts.root)} if artifacts.local else {}
    if file := settings.database_file:
        found["database"] = file.resolve().parent
    return found


def free_bytes(folder: Path) -> int:
    """Return the free bytes of the disk on which a folder is, or will be at the first start."""
    return shutil.disk_usage(existing(folder)).free


def shortage(settings: Settings, artifacts: Artifacts) -> str | None:
    """Return a warning about the fullest disk; None while all have enough space."""
    free = {use: free_bytes(one) for use, one in folders(settings, artifacts).items()}
    if not free or min(free.values()) >= settings.min_free_bytes:
        return None
    use = min(free, key=lambda one: free[one])
    return (
        f"The disk of the {use} has {size(free[use])} left. When it is full, runs keep their "
        "last checkpoint and lose what they compute after it"
    )


def is_full(settings: Settings, artifacts: Artifacts) -> bool:
    return any(free_bytes(one) < FULL_BYTES for one in folders(settings, artifacts).values())
