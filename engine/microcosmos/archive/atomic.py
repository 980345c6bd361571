"""Atomic writing of files: write beside, sync, rename, sync the folder."""

import fcntl
import hashlib
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4


def write_whole(path: Path, data: bytes) -> None:
    """Replace a file, which keeps its permissions. Raises `OSError` with the file's name.

    The old content stays readable on any failure.

    Parts that killed processes left beside this file are removed.
    """
    path = place(path)
    remove_left(path)
    beside = part_of(path)
    try:
        with beside.open("wb") as file:
            with suppress(OSError):  # Some file systems have no locks.
                fcntl.flock(file, fcntl.LOCK_EX)
            with suppress(OSError):  # There is no old file, or its system has no permissions.
                # Before the content: others must not read a part that they may not read whole.
                os.fchmod(file.fileno(), stat.S_IMODE(path.stat().st_mode))
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
            beside.replace(path)
    except BaseException as error:  # Ctrl-C too.
        with suppress(OSError):
            beside.unlink()
        if isinstance(error, OSError) and error.errno is not None:
            raise _renamed(error, path) from error
        raise
    sync_folder(path.parent)


def place(path: Path) -> Path:
    """Return where a file is written: the end of a link, which stays a link.

    Raises `OSError` for a folder, a device or a pipe, which a file in its place would destroy,
    and for a file that may not be written: only its folder decides whether it can be replaced.
    """
    with suppress(FileNotFoundError, NotADirectoryError):
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(f"a file is needed, got the folder {path}")
        if not stat.S_ISREG(mode):
            raise FileExistsError(f"a file is needed, got {path}, a device or a pipe")
        if not os.access(path, os.W_OK):
            raise PermissionError(f"a file that may be written is needed, got {path}")
    return path.resolve() if path.is_symlink() else path


def part_of(path: Path) -> Path:
    """Return a new name beside a file or a folder, under which it is written first."""
    # It is never used again: another writer may be about to remove an earlier part.
    return path.with_name(f".{_mark(path)}.{uuid4().hex}.part")


def remove_left(path: Path) -> None:
    """Remove parts of a file or a folder that no process writes any more.

    A writer locks its part while it is empty, and a lock ends with its process: a part with
    content and without a lock has lost its writer.
    """
    # In a folder that may be written and not listed, `glob` finds nothing.
    for part in path.parent.glob(f".{_mark(path)}.*.part"):
        with suppress(OSError):
            _remove_unheld(part)


def _remove_unheld(part: Path) -> None:
    folder = part.is_dir()
    # NFS locks no file that is open for reading alone; a folder cannot be opened for writing.
    opened = os.open(part, os.O_RDONLY if folder else os.O_RDWR)
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)  # Fails while one is writing.
        if folder and any(part.iterdir()):
            shutil.rmtree(part)
        elif not folder and os.fstat(opened).st_size:
            part.unlink()
    finally:
        os.close(opened)


@contextmanager
def folder_part(path: Path) -> Iterator[Path]:
    """Make a new folder beside a folder, to be moved into its place.

    It is deleted on any failure, and by `remove_left` once its process has been killed.
    """
    part = part_of(path)
    try:
        part.mkdir()
    except OSError as error:
        raise _renamed(error, path) from error
    opened = os.open(part, os.O_RDONLY)
    try:
        with suppress(OSError):  # Some file systems have no locks.
            fcntl.flock(opened, fcntl.LOCK_EX)
        yield part
    except BaseException:  # Ctrl-C too.
        shutil.rmtree(part, ignore_errors=True)
        raise
    finally:
        os.close(opened)


def _renamed(error: OSError, path: Path) -> OSError:
    """Return an error of the system with the name that people know, in place of a part's."""
    return OSError(error.errno, error.strerror, str(path))


def _mark(path: Path) -> str:
    """Return a mark of a file's name; with the whole name, a part's would be too long."""
    return hashlib.sha256(os.fsencode(path.name)).hexdigest()[:16]


def sync_folder(path: Path) -> None:
    """Write the folder's entries to disk, so that a rename in it survives a crash.

    Do nothing for a folder that may not be read: the system offers no way.
    """
    try:
        folder = os.open(path, os.O_RDONLY)
    except PermissionError:
        return
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
