"""A file fetched whole: taken up where it broke off, verified, and only then put in place."""

import hashlib
import os
import re
import time
from collections.abc import Callable
from pathlib import Path

import httpx

from .connection import Connection
from .errors import NotMicrocosmos, Refused, ServerError, unreachable

TRIES = 6
"""In a row without a byte more."""
CHUNK = 1 << 16
DIGEST = re.compile(r'"([0-9a-f]{64})"')
"""A strong ETag of ours: the file's SHA-256."""

Tell = Callable[[int, int], None]
"""Told how many bytes are there, and of how many."""


def silent(there: int, whole: int) -> None:
    """Tells nobody."""


def fetch(connection: Connection, path: str, to: Path, tell: Tell = silent) -> Path:
    """Bring what is at a path; what an attempt before has brought is not asked for again.

    It lies beside the file until it is whole, under the hash that it will have: where the
    server has another one by then, it is begun anew. Raises `ServerError` or `OSError`.
    """
    if not to.parent.is_dir():
        raise NotADirectoryError(f"{to.name} needs an existing folder; got {to.parent}")
    there, tries = digest(to) if to.exists() else None, 0
    while True:
        part = begun(to)
        before = size(part)
        try:
            found = _more(connection, path, to, part, there, tell)
        except httpx.TransportError as error:
            tries = 0 if size(begun(to)) > before else tries + 1
            if tries >= TRIES:
                raise unreachable(error, connection.url) from error
            time.sleep(min(8.0, 0.25 * 2**tries))
            continue
        if found is not None:
            _place(found, to)
        return to


def _more(
    connection: Connection,
    path: str,
    to: Path,
    part: Path | None,
    there: str | None,
    tell: Tell,
) -> Path | None:
    """The part, whole; None where the file is there already."""
    headers = {"Accept-Encoding": "identity"}
    headers |= {"If-None-Match": f'"{there}"'} if there else {}
    if part:
        headers |= {"Range": f"bytes={size(part)}-", "If-Range": f'"{_named(part)}"'}
    try:
        with connection.stream(path, headers=headers) as answer:
            if answer.status_code == 304:
                return None
            return _written(answer, to, part, tell, connection.url)
    except Refused as error:
        if error.status != 416 or not part:
            raise
        return part  # Nothing is left to ask for: it broke off after the last byte.


def _written(answer: httpx.Response, to: Path, part: Path | None, tell: Tell, url: str) -> Path:
    """The part with what an answer brings, behind what is there or in its place."""
    name = DIGEST.fullmatch(answer.headers.get("etag", ""))
    if not name:
        raise NotMicrocosmos(f"{url} sends a file without its hash, as no server of ours does.")
    target = to.with_name(f".{to.name}.{name[1]}.part")
    goes_on = answer.status_code == 206 and target == part
    if part and not goes_on:
        part.unlink(missing_ok=True)
    start = size(target) if goes_on else 0
    whole = start + int(answer.headers.get("content-length", 0))  # Some proxies drop it.
    try:
        with target.open("ab" if goes_on else "wb") as file:
            tell(start, whole)
            for chunk in answer.iter_raw(CHUNK):
                file.write(chunk)
                file.flush()
                start += len(chunk)
                tell(start, max(start, whole))
            os.fsync(file.fileno())
    except OSError as error:  # Of a full disk, which does not say whose.
        error.filename = error.filename or str(target)
        raise
    return target


def _place(part: Path, to: Path) -> None:
    """Rename what is whole and right; what is not is removed."""
    needed, found = _named(part), digest(part)
    if needed != found:
        part.unlink()
        raise ServerError(
            f"{to.name} must have the SHA-256 {needed}, got {found}: it was damaged on its "
            "way, and is not kept. Try again."
        )
    part.replace(to)
    folder = os.open(to.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def begun(to: Path) -> Path | None:
    """What an attempt before has left of a file."""
    beside = re.compile(rf"\.{re.escape(to.name)}\.[0-9a-f]{{64}}\.part")
    found = (path for path in to.parent.iterdir() if beside.fullmatch(path.name))
    return next(found, None)


def size(path: Path | None) -> int:
    return path.stat().st_size if path else 0


def digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _named(part: Path) -> str:
    """The hash that a part is to have."""
    return part.name.split(".")[-2]
