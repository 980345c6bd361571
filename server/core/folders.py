"""The data folder, which holds everything that anybody made here."""

import stat
from pathlib import Path


def private(folder: Path) -> None:
    """Make a folder into which no other user of this machine can look.

    One that is there stays as it is: somebody may have opened it to a group.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)


def open_to_others(folder: Path) -> bool:
    return bool(stat.S_IMODE(folder.stat().st_mode) & stat.S_IRWXO)
