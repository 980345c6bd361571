"""One reader of the event stream in a process, for any number of listeners."""

import asyncio
import logging
from collections.abc import AsyncIterator, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from fastapi.sse import ServerSentEvent
from redis import RedisError
from redis.asyncio import Redis

ROOM = 1000
"""Events that may wait for a slow listener, before it is told to fetch everything anew."""
PAGE = 500
BLOCK_MS = 1000

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Entry:
    """An event at its place in the stream."""

    id: str
    kind: str
    run: str = ""
    data: str = "{}"

    @property
    def place(self) -> tuple[int, int]:
        return place(self.id)

    def sent(self) -> ServerSentEvent:
        return ServerSentEvent(id=self.id, event=self.kind, raw_data=self.data)


@dataclass(eq=False)
class Listener:
    """What has arrived for one client since a place in the stream; None is the end."""

    since: str
    token: UUID | None = None
    """What it was opened with; it ends when that does."""
    waiting: asyncio.Queue[Entry | None] = field(default_factory=lambda: asyncio.Queue(ROOM))

    def put(self, entry: Entry | None) -> None:
        if self.waiting.full():
            while not self.waiting.empty():
                self.waiting.get_nowait()
            entry = entry and Entry(entry.id, "reset")
        self.waiting.put_nowait(entry)


class Hub:
    """Reads the stream while it `run`s, until it is closed."""

    def __init__(self, url: str, stream: str):
        # Reading blocks, so that a timeout of the socket must not end it.
        self.redis: Any = Redis.from_url(url, socket_timeout=None, socket_connect_timeout=2)
        self.stream = stream
        self.read_up_to = "0-0"
        self.listeners: set[Listener] = set()
        self.reached = False
        self.closed = False

    async def begin(self) -> None:
        """Find the end of the stream, from where it is read."""
        with suppress(RedisError):  # Then `run` finds it when Redis answers.
            self.read_up_to = await self._newest()
            self.reached = True

    async def run(self) -> None:
        """Hand on what is published. After an outage everybody is told to fetch anew."""
        while not self.closed:
            try:
                if not self.reached:
                    self.read_up_to = await self._newest()
                    self._hand_on(Entry(self.read_up_to, "reset"))
                    self.reached = True
                for entry in await self._next():
                    self.read_up_to = entry.id
                    self._hand_on(entry)
            except RedisError as error:
                log.warning("no events until Redis answers: %s", error)
                self.reached = False
                await asyncio.sleep(1)

    @contextmanager
    def listening(self, token: UUID | None = None) -> Iterator[Listener]:
        listener = Listener(self.read_up_to, token)
        self.listeners.add(listener)
        if self.closed:
            listener.put(None)
        try:
            yield listener
        finally:
            self.listeners.discard(listener)

    async def follow(
        self, listener: Listener, after: str | None, run: str | None
    ) -> AsyncIterator[ServerSentEvent]:
        """What comes after an event, in order, once each; `reset` where that is gone."""
        start = listener.since
        if after is None:
            yield ServerSentEvent(id=start, comment="from here on")
        elif not await self._keeps(after):
            yield Entry(start, "reset").sent()
        else:
            start = after
            async for entry in self._missed(after):
                start = entry.id
                if run in (None, entry.run):
                    yield entry.sent()
        while (entry := await listener.waiting.get()) is not None:
            new = entry.place > place(start) and run in (None, entry.run)
            if new or entry.kind == "reset":
                yield entry.sent()

    def close(self) -> None:
        """End all streams: clients come back with the last id they have seen."""
        self.closed = True
        for listener in self.listeners:
            listener.put(None)

    def tokens(self) -> set[UUID]:
        """Those with which somebody listens."""
        return {listener.token for listener in self.listeners if listener.token}

    def end(self, tokens: Collection[UUID]) -> None:
        """End the streams that were opened with some tokens."""
        for listener in self.listeners:
            if listener.token in tokens:
                listener.put(None)

    def _hand_on(self, entry: Entry) -> None:
        for listener in self.listeners:
            listener.put(entry)

    async def _next(self) -> list[Entry]:
        found = await self.redis.xread({self.stream: self.read_up_to}, PAGE, BLOCK_MS)
        return [_entry(*item) for _, items in found or [] for item in items]

    async def _newest(self) -> str:
        newest = await self.redis.xrevrange(self.stream, count=1)
        return newest[0][0].decode() if newest else "0-0"

    async def _keeps(self, after: str) -> bool:
        """Whether the stream still has everything that came after an event."""
        try:
            first = await self.redis.xrange(self.stream, count=1)
            newest = await self._newest()
            if not first:
                return place(after) == (0, 0)
            return place(first[0][0].decode()) <= place(after) <= place(newest)
        except (ValueError, RedisError):
            return False

    async def _missed(self, after: str) -> AsyncIterator[Entry]:
        while page := await self.redis.xrange(self.stream, min=f"({after}", count=PAGE):
            for item in page:
                entry = _entry(*item)
                after = entry.id
                yield entry


def place(identifier: str) -> tuple[int, int]:
    """An id as numbers, which ids are ordered by."""
    milliseconds, _, number = identifier.partition("-")
    return int(milliseconds), int(number or 0)


def _entry(identifier: Any, fields: Any) -> Entry:
    kind, run, data = (fields[key].decode() for key in (b"event", b"run", b"data"))
    return Entry(identifier.decode(), kind, run, data)
