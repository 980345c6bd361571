"""Answers as bytes: made once, kept within a limit of memory, revalidated by entity tags."""

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

from .errors import RETRY_AFTER, Unavailable

# Most bytes of an archive are hashes and floats, which higher levels hardly compress.
GZIP_LEVEL = 1


class AnswerCache:
    """The latest answers of this process, by tag: the bytes of a tag never change.

    `threads` make answers at once. Requests wait for them without a thread, and requests for
    the same bytes wait together.
    """

    def __init__(self, kept_bytes: int, threads: int = 2, waiting: int = 64):
        self.kept_bytes, self.waiting = kept_bytes, waiting
        # A pool of its own: one archive may take seconds, and FastAPI runs all other routes in
        # its 40 threads.
        self._pool = ThreadPoolExecutor(threads, thread_name_prefix="answers")
        # One thread, so that anonymous requests never have all.
        self._anonymous_pool = ThreadPoolExecutor(1, thread_name_prefix="anonymous")
        self._kept = OrderedDict[str, bytes]()
        self._size = 0
        self._making = dict[str, asyncio.Task[bytes]]()

    async def get(
        self, tag: str, make: Callable[[], bytes], *, anonymous: bool = False
    ) -> bytes:
        """Return the bytes of a tag; `make` makes them in a thread if they are not kept.

        Raise `DomainError` if many others are being made; for `anonymous` requests, if a few
        are: they must not take all places.
        """
        if tag in self._kept:
            self._kept.move_to_end(tag)
            return self._kept[tag]
        if tag not in self._making:
            if len(self._making) >= (self.waiting // 4 if anonymous else self.waiting):
                detail = "The server prepares many answers already; try again."
                raise Unavailable(detail, title="Busy", headers=RETRY_AFTER)
            pool = self._anonymous_pool if anonymous else self._pool
            self._making[tag] = asyncio.create_task(self._make(tag, make, pool))
        # Others wait for the same bytes, so a client that leaves must not cancel them.
        return await asyncio.shield(self._making[tag])

    async def _make(
        self, tag: str, make: Callable[[], bytes], pool: ThreadPoolExecutor
    ) -> bytes:
        try:
            content = await asyncio.get_running_loop().run_in_executor(pool, make)
        finally:
            # Also after an error, which is not kept: the next request tries again
            # (tests/server/core/test_answers.py).
            del self._making[tag]
        if len(content) <= self.kept_bytes:
            self._kept[tag] = content
            self._size += len(content)
        while self._size > self.kept_bytes:
            _, oldest = self._kept.popitem(last=False)
            self._size -= len(oldest)
        return content

    def close(self) -> None:
        for pool in (self._pool, self._anonymous_pool):
            pool.shutdown(cancel_futures=True)


def tag_of(*parts: Any) -> str:
    """Return a tag of everything on which an answer depends.

    Long parts take time: call it in a thread.
    """
    return sha256(repr(parts).encode()).hexdigest()[:32]


async def respond(
    request: Request,
    tag: str,
    make: Callable[[], bytes],
    media_type: str,
    headers: dict[str, str],
) -> Response:
    """Return 304 if the client has the answer of a tag, else its bytes, compressed if allowed.

    Clients keep the answer and ask each time whether it is still current.
    """
    zipped = accepts(request, "accept-encoding", "gzip")
    # Two encodings of one answer need two strong tags (RFC 9110, 8.8.3).
    etag = f'"{tag}-gzip"' if zipped else f'"{tag}"'
    headers = {"ETag": etag, "Vary": "Accept-Encoding", **headers}
    if knows(request, etag):
        return Response(status_code=304, headers=headers)
    if zipped:
        headers["Content-Encoding"] = "gzip"
        make = partial(_zipped, make)
    anonymous = request.state.share is not None
    content = await request.app.state.answers.get(etag, make, anonymous=anonymous)
    return Response(content, headers=headers, media_type=media_type)


def revalidated(request: Request, answer: Response) -> Response:
    """Return 304 if the client has the bytes of an answer already, else the answer."""
    etag = f'"{sha256(answer.body).hexdigest()[:32]}"'
    if knows(request, etag):
        return Response(status_code=304, headers={"ETag": etag})
    answer.headers["ETag"] = etag
    return answer


def knows(request: Request, etag: str) -> bool:
    """Return whether the client has the answer of an entity tag."""
    sent = ",".join(request.headers.getlist("if-none-match")).split(",")
    # The comparison is weak (RFC 9110, 13.1.2): proxies like nginx mark the tags of what they
    # compress by `W/`.
    known = [tag.strip().removeprefix("W/") for tag in sent]
    return etag in known or "*" in known


def accepts(request: Request, header: str, name: str) -> bool:
    """Return whether a header like `Accept` names a value, and not with a weight of 0."""
    for one in ",".join(request.headers.getlist(header)).split(","):
        value, *parameters = (part.strip().lower() for part in one.split(";"))
        if value == name:
            weights = [part[2:] for part in parameters if part.startswith("q=")]
            return not weights or weights[0].strip("0.") != ""
    return False


def _zipped(make: Callable[[], bytes]) -> bytes:
    # Without the time, the bytes of a tag are always the same.
    return gzip.compress(make(), GZIP_LEVEL, mtime=0)
