"""The event stream: one reader serves all listeners of a process, and the route."""

import asyncio
import logging
from collections.abc import AsyncIterable, AsyncIterator, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent
from redis import RedisError, TimeoutError
from redis.asyncio import Redis

from ..auth.authorize import Reader
from ..queue.jobs import ANSWER_SECONDS
from ..services.messages import RESET

QUEUE_SIZE, QUEUE_LENGTH = 1000, 16_000_000
"""Events that wait for a slow listener, and their length in characters; with more it has to
fetch everything again."""
PAGE, PAGE_LENGTH = 100, 1_000_000
"""Most events to read at once, and their length in bytes: one may have a megabyte."""
# A closing server waits at most this long for a read to end.
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


@dataclass
class Pace:
    """The number of events to read at once: few of long ones, which clients read slowly."""

    count: int = 1

    def note(self, entries: Sequence[Entry]) -> None:
        """Take the next number from the length of the last ones."""
        if entries:  # While nothing comes, it is unknown how long the next ones are.
            mean = sum(len(one.data) for one in entries) / len(entries)
            self.count = max(1, min(PAGE, 4 * self.count, int(PAGE_LENGTH / (mean + 1))))


@dataclass(eq=False)
class Listener:
    """The events that wait for one client; None is the end."""

    since: str
    token: UUID | None = None
    """The token that opened the stream; the stream ends with it."""
    waiting: asyncio.Queue[Entry | None] = field(
        default_factory=lambda: asyncio.Queue(QUEUE_SIZE)
    )
    length: int = 0
    """The length of the events that wait, in characters."""

    def put(self, entry: Entry | None) -> None:
        # Dropped, not waited for: one slow client must neither fill the memory nor hold up
        # others.
        if self.waiting.full() or (entry and self.length + len(entry.data) > QUEUE_LENGTH):
            while not self.waiting.empty():
                self.waiting.get_nowait()
            self.length, entry = 0, entry and Entry(entry.id, RESET)
        self.length += len(entry.data) if entry else 0
        self.waiting.put_nowait(entry)

    async def get(self) -> Entry | None:
        """Wait for the next event."""
        entry = await self.waiting.get()
        self.length -= len(entry.data) if entry else 0
        return entry


class Fanout:
    """Hands events to listeners while `run` runs, until it is closed."""

    def __init__(self, url: str, stream: str):
        # Reading blocks for a while; a frozen Redis blocks longer, and then messages are lost.
        patience = BLOCK_MS / 1000 + ANSWER_SECONDS
        self.redis: Any = Redis.from_url(
            url, socket_timeout=patience, socket_connect_timeout=ANSWER_SECONDS
        )
        self.stream = stream
        self.read_up_to = "0-0"
        self.listeners: set[Listener] = set()
        self.connected = False
        self.closed = False
        self._pace = Pace()

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
                    self._broadcast(Entry(self.read_up_to, RESET))
                    self.connected = True
                at = {self.stream: self.read_up_to}
                found = await self.redis.xread(at, self._pace.count, BLOCK_MS)
                entries = [_entry(*item) for _, items in found or [] for item in items]
                self._pace.note(entries)
                for entry in entries:
                    self.read_up_to = entry.id
                    self._broadcast(entry)
            except TimeoutError:
                # It is busy or frozen, and has its stream. Who drops events meanwhile tells of
                # that in the stream itself.
                log.warning("Redis is silent; events are late")
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
        """Yield `start`, or after an id all later events, `reset` if some of them are lost.

        New events follow in order.
        """
        start = listener.since
        try:
            if after is None:
                yield Entry(start, "start").sent()
            elif not await self._contains(after):
                yield Entry(start, RESET).sent()
            else:
                start, pace = after, Pace()
                while page := await self._page(start, pace):
                    for entry in page:
                        start = entry.id
                        if run in (None, entry.run) or entry.kind == RESET:
                            yield entry.sent()
                    # The client reads a page at its own pace, and long events trim many.
                    if not await self._contains(start):
                        start = listener.since
                        yield Entry(start, RESET).sent()
                        break
        except RedisError:  # It is away, or refuses a malformed id.
            start = listener.since
            yield Entry(start, RESET).sent()
        while (entry := await listener.get()) is not None:
            new = position(entry.id) > position(start) and run in (None, entry.run)
            if new or entry.kind == RESET:
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

    async def _page(self, after: str, pace: "Pace") -> list[Entry]:
        found = await self.redis.xrange(self.stream, min=f"({after}", count=pace.count)
        entries = [_entry(*item) for item in found]
        pace.note(entries)
        return entries

    async def _newest(self) -> str:
        # Of all events, also of those that were trimmed since.
        if not await self.redis.exists(self.stream):
            return "0-0"
        return (await self.redis.xinfo_stream(self.stream))["last-generated-id"].decode()

    async def _contains(self, after: str) -> bool:
        try:
            last = position(after)
        except ValueError:
            return False
        newest = position(await self._newest())
        first = await self.redis.xrange(self.stream, count=1)
        if not first:
            return last == newest
        return position(first[0][0].decode()) <= last <= newest


def position(identifier: str) -> tuple[int, int]:
    """Return the two numbers of an id; ids are ordered by them."""
    # As numbers: the text 10-0 would be before 9-0.
    milliseconds, _, number = identifier.partition("-")
    return int(milliseconds), int(number or 0)


def _entry(identifier: Any, fields: Any) -> Entry:
    kind, run, data = (fields[key].decode() for key in (b"event", b"run", b"data"))
    return Entry(identifier.decode(), kind, run, data)


router = APIRouter(prefix="/events", tags=["events"])


async def listener(request: Request, principal: Reader) -> AsyncIterator[Listener]:
    """Listen before the answer starts, so that a state read later misses no event."""
    with request.app.state.fanout.listening(principal.token) as listener:
        yield listener


@router.get("", response_class=EventSourceResponse)
async def events(
    request: Request,
    listener: Annotated[Listener, Depends(listener)],
    run: UUID | None = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """Stream all events, or those of one run. It goes on after `Last-Event-ID`."""
    fanout = request.app.state.fanout
    async for event in fanout.follow(listener, last_event_id, str(run) if run else None):
        yield event
