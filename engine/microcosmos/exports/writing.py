"""Write exports into folders: whole or not at all, and never over another file."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

from ..archive.atomic import sync_folder, write_whole


def refuse_existing(folder: Path, what: str = "--to") -> None:
    """Raise `FileExistsError` where a folder has content, or is a file."""
    if folder.is_dir() and not any(folder.iterdir()):
        return
    if folder.exists() or folder.is_symlink():
        raise FileExistsError(
            f"{what} needs a new or empty folder, because nothing is overwritten; got {folder}"
        )


def write(files: Mapping[str, bytes], folder: Path) -> list[Path]:
    """Write files into a new or empty folder, and return their paths.

    They are written beside it first, so that a failure leaves no half of them. Raises
    `FileExistsError` for a folder with content, and `OSError`.
    """
    refuse_existing(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    beside = folder.with_name(f".{folder.name}.{os.getpid()}.part")
    try:
        for name, data in files.items():
            path = beside / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, data)
        beside.replace(folder)  # It replaces an empty folder too.
    except OSError:
        shutil.rmtree(beside, ignore_errors=True)
        raise
    sync_folder(folder.parent)
    return [folder / name for name in files]
