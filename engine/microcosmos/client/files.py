"""Download a file: resumed if it breaks off, verified, and only then put in place."""

import fcntl
import hashlib
import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx
from rich.console import Console
from rich.progress import (
    BarColumn,
    DownloadColumn,
    Progress,
    TextColumn,
    TimeRemainingColumn,
    TransferSpeedColumn,
)

from ..archive.atomic import place, sync_folder
from .connection import Connection
from .errors import NotMicrocosmos, Refused, ServerError, unreachable
from .formatting import visible

TRIES = 6
"""Maximum number of successive tries without a new byte."""
CHUNK = 1 << 16
DIGEST = re.compile(r'"([0-9a-f]{64})"')
"""A strong ETag of the server: the file's SHA-256."""

Tell = Callable[[int, int], None]
"""Called with the number of bytes so far, and of the whole file."""


def silent(received: int, total: int) -> None:
    """Ignore the progress."""


@contextmanager
def progress_bar(name: str, quiet: bool = False) -> Iterator[Tell]:
    """Draw a progress bar if standard error is a terminal."""
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield silent
        return
    # Names may have brackets, which are no markup.
    description = TextColumn("{task.description}", markup=False)
    rate = TransferSpeedColumn()
    columns = (description, BarColumn(), DownloadColumn(), rate, TimeRemainingColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task(visible(name), total=None)
        yield lambda received, total: progress.update(task, completed=received, total=total)


def fetch(connection: Connection, path: str, to: Path, tell: Tell = silent) -> Path:
    """Download a file; bytes of an earlier attempt are not requested again.

    A part beside the file has the expected hash in its name: if the server has another file by
    then, the download starts anew. Raise `ServerError` or `OSError`.
    """
    whole = place(to)
    if not whole.parent.is_dir():
        raise NotADirectoryError(f"{to.name} needs an existing folder; got {whole.parent}")
    with _alone(whole):
        _fetch(connection, path, whole, tell)
    return to


@contextmanager
def _alone(to: Path) -> Iterator[None]:
    """Wait while another thread or process downloads the same file: both would write one part
    (test_downloads_of_one_file_at_once_take_turns)."""
    beside = to.with_name(f".{to.name}.pull")
    while True:
        with beside.open("ab") as lock:
            with suppress(OSError):  # Some file systems have no locks.
                fcntl.flock(lock, fcntl.LOCK_EX)
            try:
                held = os.path.samestat(os.fstat(lock.fileno()), beside.stat())
            except FileNotFoundError:
                held = False
            if not held:  # The one before removed this file: its lock would hold off nobody.
                continue
            try:
                yield
            finally:
                beside.unlink(missing_ok=True)
            return


def _fetch(connection: Connection, path: str, to: Path, tell: Tell) -> None:
    sha, tries = digest(to) if to.exists() else None, 0
    while True:
        part = part_of(to)
        before = size(part)
        try:
            completed = _more(connection, path, to, part, sha, tell)
        except httpx.TransportError as error:
            # A slow line that makes progress is never given up.
            tries = 0 if size(part_of(to)) > before else tries + 1
            if tries >= TRIES:
                raise unreachable(error, connection.url) from error
            time.sleep(min(8.0, 0.25 * 2**tries))
            continue
        if completed is not None:
            _place(completed, to)
        return


def _more(
    connection: Connection, path: str, to: Path, part: Path | None, sha: str | None, tell: Tell
) -> Path | None:
    """Return the completed part; None if the file exists already."""
    # The bytes of a compressed answer could not be resumed at a number.
    headers = {"Accept-Encoding": "identity"}
    headers |= {"If-None-Match": f'"{sha}"'} if sha else {}
    if part:
        # If the file has changed, `If-Range` brings the whole one (RFC 9110, section 13.1.5).
        headers |= {"Range": f"bytes={size(part)}-", "If-Range": f'"{_named(part)}"'}
    try:
        with connection.stream(path, headers=headers) as answer:
            if answer.status_code == 304:
                return None
            return _written(answer, to, part, tell, connection.url)
    except Refused as error:
        if error.status != 416 or not part:
            raise
        return part  # It broke off after the last byte.


def _written(answer: httpx.Response, to: Path, part: Path | None, tell: Tell, url: str) -> Path:
    """Write an answer behind the part, or in its place."""
    name = DIGEST.fullmatch(answer.headers.get("etag", ""))
    if not name:
        raise NotMicrocosmos(f"{url} sends a file without its hash, as no server of ours does.")
    target = to.with_name(f".{to.name}.{name[1]}.part")
    resumed = answer.status_code == 206 and target == part
    if part and not resumed:
        part.unlink(missing_ok=True)
    received = size(target) if resumed else 0
    total = received + int(answer.headers.get("content-length", 0))  # Some proxies drop it.
    try:
        with target.open("ab" if resumed else "wb") as file:
            tell(received, total)
            for chunk in answer.iter_raw(CHUNK):
                file.write(chunk)
                # A killed process leaves all that has arrived
                # (test_an_abandoned_download_is_continued_later).
                file.flush()
                received += len(chunk)
                tell(received, max(received, total))
            # Before the file gets its name: a power cut must not leave half a file under it.
            os.fsync(file.fileno())
    except OSError as error:  # The error of a full disk has no name.
        error.filename = error.filename or str(target)
        raise
    return target


def _place(part: Path, to: Path) -> None:
    """Put a verified part in place; delete a damaged one."""
    needed, found = _named(part), digest(part)
    if needed != found:
        part.unlink()
        raise ServerError(
            f"{to.name} must have the SHA-256 {needed}, got {found}: it was damaged on its "
            "way, and is not kept. Try again."
        )
    part.replace(to)
    sync_folder(to.parent)


def part_of(to: Path) -> Path | None:
    """Return the part that an earlier attempt has left."""
    beside = re.compile(rf"\.{re.escape(to.name)}\.[0-9a-f]{{64}}\.part")
    parts = (path for path in to.parent.iterdir() if beside.fullmatch(path.name))
    return next(parts, None)


def size(path: Path | None) -> int:
    return path.stat().st_size if path else 0


def digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _named(part: Path) -> str:
    return part.name.split(".")[-2]
