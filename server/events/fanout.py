"""Fan-out: one reader of the event stream serves all listeners of a process."""

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

QUEUE_SIZE = 1000
"""Events that wait for a slow listener; with more it has to fetch everything again."""
PAGE = 500
BLOCK_MS = 1000

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Entry:
    id: str
    kind: str
    run: str = ""
    data: str = "{}"

    def sent(self) -> ServerSentEvent:
        return ServerSentEvent(id=self.id, event=self.kind, raw_data=self.data)


@dataclass(eq=False)
class Listener:
    """The events that wait for one client; None is the end."""

    since: str
    token: UUID | None = None
    """The token that opened the stream; the stream ends with it."""
    waiting: asyncio.Queue[Entry | None] = field(
        default_factory=lambda: asyncio.Queue(QUEUE_SIZE)
    )

    def put(self, entry: Entry | None) -> None:
        if self.waiting.full():
            while not self.waiting.empty():
                self.waiting.get_nowait()
            entry = entry and Entry(entry.id, "reset")
        self.waiting.put_nowait(entry)


class Fanout:
    """Hands events to listeners while `run` runs, until it is closed."""

    def __init__(self, url: str, stream: str):
        # Reading blocks, so a timeout of the socket must not end it.
        self.redis: Any = Redis.from_url(url, socket_timeout=None, socket_connect_timeout=2)
        self.stream = stream
        self.read_up_to = "0-0"
        self.listeners: set[Listener] = set()
        self.connected = False
        self.closed = False

    async def start(self) -> None:
        """Find the end of the stream; `run` does it later if Redis does not answer."""
        with suppress(RedisError):
            self.read_up_to = await self._newest()
            self.connected = True

    async def run(self) -> None:
        """Hand on new events. After an outage, have all listeners fetch everything again."""
        while not self.closed:
            try:
                if not self.connected:
                    self.read_up_to = await self._newest()
                    self._broadcast(Entry(self.read_up_to, "reset"))
                    self.connected = True
                found = await self.redis.xread({self.stream: self.read_up_to}, PAGE, BLOCK_MS)
                for entry in (_entry(*item) for _, items in found or [] for item in items):
                    self.read_up_to = entry.id
                    self._broadcast(entry)
            except RedisError as error:
                log.warning("no events until Redis answers: %s", error)
                self.connected = False
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
        """Yield all later events in order; `reset` if the stream has lost some of them."""
        start = listener.since
        if after is None:
            yield ServerSentEvent(id=start, comment="new events follow")
        elif not await self._contains(after):
            yield Entry(start, "reset").sent()
        else:
            start = after
            while page := await self.redis.xrange(self.stream, min=f"({start}", count=PAGE):
                for entry in (_entry(*item) for item in page):
                    start = entry.id
                    if run in (None, entry.run):
                        yield entry.sent()
        while (entry := await listener.waiting.get()) is not None:
            new = position(entry.id) > position(start) and run in (None, entry.run)
            if new or entry.kind == "reset":
                yield entry.sent()

    def close(self) -> None:
        """End all streams. Clients reconnect with the last id that they received."""
        self.closed = True
        for listener in self.listeners:
            listener.put(None)

    def tokens(self) -> set[UUID]:
        return {listener.token for listener in self.listeners if listener.token}

    def end(self, tokens: Collection[UUID]) -> None:
        """End the streams that some tokens opened."""
        for listener in self.listeners:
            if listener.token in tokens:
                listener.put(None)

    def _broadcast(self, entry: Entry) -> None:
        for listener in self.listeners:
            listener.put(entry)

    async def _newest(self) -> str:
        newest = await self.redis.xrevrange(self.stream, count=1)
        return newest[0][0].decode() if newest else "0-0"

    async def _contains(self, after: str) -> bool:
        try:
            first = await self.redis.xrange(self.stream, count=1)
            newest = await self._newest()
            if not first:
                return position(after) == (0, 0)
            return position(first[0][0].decode()) <= position(after) <= position(newest)
        except (ValueError, RedisError):
            return False


def position(identifier: str) -> tuple[int, int]:
    """Return the two numbers of an id; ids are ordered by them."""
    milliseconds, _, number = identifier.partition("-")
    return int(milliseconds), int(number or 0)


def _entry(identifier: Any, fields: Any) -> Entry:
    kind, run, data = (fields[key].decode() for key in (b"event", b"run", b"data"))
    return Entry(identifier.decode(), kind, run, data)
