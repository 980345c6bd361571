"""Folders that other users of the machine cannot read."""

import stat
from pathlib import Path


def create_private(folder: Path) -> None:
    """Create a folder that no other user can read; leave an existing one as it is."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)


def open_to_others(folder: Path) -> bool:
    return bool(stat.S_IMODE(folder.stat().st_mode) & stat.S_IRWXO)
