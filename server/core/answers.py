"""Answers as bytes: made once, kept within a limit of memory, and revalidated by their tags."""

import asyncio
import gzip
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from hashlib import sha256
from typing import Any

from starlette.requests import Request
from starlette.responses import Response

from .errors import RETRY_AFTER, ProblemError

GZIP_LEVEL = 1
"""Most bytes of an archive are hashes and floats, which higher levels hardly compress."""


class AnswerCache:
    """The latest answers of this process, by tag: the bytes of a tag never change.

    `threads` make answers at once. Requests wait for them without a thread, and requests for
    the same bytes wait together.
    """

    def __init__(self, kept_bytes: int, threads: int = 2, waiting: int = 64):
        self.kept_bytes, self.waiting = kept_bytes, waiting
        self._pool = ThreadPoolExecutor(threads, thread_name_prefix="answers")
        self._kept = OrderedDict[str, bytes]()
        self._size = 0
        self._making = dict[str, asyncio.Task[bytes]]()

    async def get(self, tag: str, make: Callable[[], bytes]) -> bytes:
        """Return the bytes of a tag; `make` makes them in a thread if they are not kept.

        Raise `ProblemError` if many others are being made.
        """
        if tag in self._kept:
            self._kept.move_to_end(tag)
            return self._kept[tag]
        if tag not in self._making:
            if len(self._making) >= self.waiting:
                detail = "The server prepares many answers already; try again."
                raise ProblemError(503, "Busy", detail, headers=RETRY_AFTER)
            self._making[tag] = asyncio.create_task(self._make(tag, make))
        # Others wait for the same bytes, so a client that leaves must not cancel them.
        return await asyncio.shield(self._making[tag])

    async def _make(self, tag: str, make: Callable[[], bytes]) -> bytes:
        try:
            content = await asyncio.get_running_loop().run_in_executor(self._pool, make)
        finally:
            del self._making[tag]
        if len(content) <= self.kept_bytes:
            self._kept[tag] = content
            self._size += len(content)
        while self._size > self.kept_bytes:
            _, oldest = self._kept.popitem(last=False)
            self._size -= len(oldest)
        return content

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)


def tag_of(*parts: Any) -> str:
    """Return a tag of everything on which an answer depends."""
    return sha256(repr(parts).encode()).hexdigest()[:32]


async def respond(
    request: Request,
    answers: AnswerCache,
    tag: str,
    make: Callable[[], bytes],
    media_type: str,
    headers: dict[str, str],
) -> Response:
    """Return 304 if the client has the answer of a tag, else its bytes, compressed if allowed.

    Clients keep the answer and ask each time whether it is still current, unless `headers` say
    otherwise.
    """
    zipped = _accepts_gzip(request.headers.get("accept-encoding", ""))
    etag = f'"{tag}-gzip"' if zipped else f'"{tag}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding", **headers}
    if knows(request, etag):
        return Response(status_code=304, headers=headers)
    if zipped:
        headers["Content-Encoding"] = "gzip"
        make = partial(_zipped, make)
    return Response(await answers.get(etag, make), headers=headers, media_type=media_type)


def knows(request: Request, etag: str) -> bool:
    """Return whether the client has the answer of an entity tag."""
    sent = request.headers.get("if-none-match", "").split(",")
    known = [tag.strip().removeprefix("W/") for tag in sent]
    return etag in known or "*" in known


def _accepts_gzip(accepted: str) -> bool:
    """Return whether `Accept-Encoding` names gzip, and not with a weight of 0."""
    for coding in accepted.split(","):
        name, _, weight = coding.replace(" ", "").partition(";q=")
        if name.lower() == "gzip":
            return weight.strip("0.") != "" or not weight
    return False


def _zipped(make: Callable[[], bytes]) -> bytes:
    return gzip.compress(make(), GZIP_LEVEL, mtime=0)
