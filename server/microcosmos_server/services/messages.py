"""Messages over Redis: the stream of events, and the channel that wakes workers.

SQL holds the state of all runs, and a message says only that it has changed: pages fetch it,
and workers look from time to time. So a message may be lost, and nobody may wait for one.
"""

import atexit
import json
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Lock, Thread
from typing import Any
from uuid import UUID
from weakref import WeakSet

from redis import Redis, RedisError

STREAM_LENGTH = 10_000
"""Approximate length of the stream. A client that missed more fetches everything."""
STREAM_BYTES = 100_000_000
"""Approximate bytes of the long events in the stream: the longer an event is, the fewer others
stay. The elites of one generation may have megabytes, and Redis keeps all in memory."""
RESET = "reset"
"""The kind of an event that tells clients to fetch everything."""
WAITING, WAITING_BYTES = 10_000, 64_000_000
"""Messages that wait for the thread that sends them, and their length; more are dropped."""
SILENT_SECONDS = 5.0
"""Seconds for which messages are dropped after Redis did not answer."""
END_SECONDS = 2.0
"""Longest time to wait at the end of a process for messages that were not sent."""

Command = tuple[Any, ...]

log = logging.getLogger(__name__)


class Messenger:
    """Sends commands to Redis in order, in a thread: neither a request nor a run waits.

    While Redis does not answer, commands are dropped. The first one after that follows
    `after_loss`.
    """

    def __init__(self, redis: Redis, after_loss: Callable[[], Command]):
        self._redis, self._after_loss = redis, after_loss
        self._waiting = Queue[Command](WAITING)
        self._lock, self._delivering = Lock(), Lock()
        self._thread: Thread | None = None
        self._lost = False
        self._bytes = 0
        self._silent_until = 0.0
        _MESSENGERS.add(self)

    def send(self, *command: Any) -> None:
        with self._lock:
            if self._thread is None:
                self._thread = Thread(target=self._work, name="messages", daemon=True)
                self._thread.start()
            if self._bytes > WAITING_BYTES:
                self._lost = True
                return
            try:
                self._waiting.put_nowait(command)
            except Full:
                self._lost = True
            else:
                self._bytes += _length(command)

    def flush(self, seconds: float = END_SECONDS) -> None:
        """Wait until all commands are sent or dropped, or for some seconds."""
        with self._waiting.all_tasks_done:
            self._waiting.all_tasks_done.wait_for(
                lambda: not self._waiting.unfinished_tasks, seconds
            )

    def end(self) -> None:
        """Wait a moment for what is not sent, and tell of a loss if Redis answers now."""
        self.flush()
        if self._lost:
            with self._delivering:
                self._silent_until = 0.0
                self._deliver(None)

    def _work(self) -> None:
        while True:
            try:
                # After a loss others learn of it once Redis answers, not at the next message.
                command = self._waiting.get(timeout=SILENT_SECONDS if self._lost else None)
            except Empty:
                command = None
            with self._delivering:
                self._deliver(command)
            if command:
                with self._lock:
                    self._bytes -= _length(command)
                self._waiting.task_done()

    def _deliver(self, command: Command | None) -> None:
        if time.monotonic() < self._silent_until:
            self._lost = True
            return
        try:
            if self._lost:
                self._redis.execute_command(*self._after_loss())
                log.info("messages are sent again")
                self._lost = False
            if command:
                self._redis.execute_command(*command)
        except RedisError as error:
            if not self._lost:  # Once for each outage.
                log.warning("messages are dropped until Redis answers: %s", error)
            self._lost = True
            self._silent_until = time.monotonic() + SILENT_SECONDS
        except Exception:  # Without its thread nothing would be sent any more.
            log.exception("a message was not sent")


def _length(command: Command) -> int:
    return sum(len(part) for part in command if isinstance(part, str))


_MESSENGERS = WeakSet[Messenger]()


@atexit.register
def flush() -> None:
    """Wait a moment for messages of this process that were not sent."""
    for messenger in list(_MESSENGERS):
        messenger.end()


class Events:
    """The stream of events that the server and all workers write to."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.stream = f"{prefix}events"
        self.messenger = Messenger(redis, lambda: self._entry(RESET, "", "{}"))

    def publish(self, kind: str, run_id: UUID, data: dict[str, Any]) -> None:
        """Publish an event, if Redis answers."""
        # Browsers parse the data, and JSON has no NaN.
        text = json.dumps(data, allow_nan=False)
        self.messenger.send(*self._entry(kind, str(run_id), text))

    def _entry(self, kind: str, run: str, data: str) -> Command:
        length = min(STREAM_LENGTH, max(1, STREAM_BYTES // len(data)))
        trim = ("MAXLEN", "~", length)
        return "XADD", self.stream, *trim, "*", "event", kind, "run", run, "data", data

    def forget(self, seconds: float) -> None:
        """Delete events that are older; a client that missed them fetches everything."""
        now: Any = self.redis.time()
        oldest = int(1000 * (now[0] - seconds))
        self.redis.xtrim(self.stream, minid=f"{max(0, oldest)}", approximate=False)


class Wake:
    """The channel on which workers are woken; idle ones look by themselves, too."""

    def __init__(self, redis: Redis, prefix: str, messenger: Messenger):
        self._redis, self._channel = redis, f"{prefix}wake"
        self._messenger = messenger

    def send(self) -> None:
        self._messenger.send("PUBLISH", self._channel, "")

    def listen(self) -> "Alarm":
        return Alarm(self._redis, self._channel)


LATE = 0.02
"""Seconds to wait for each further message."""


class Alarm:
    """Waits for the message that wakes an idle worker."""

    def __init__(self, redis: Redis, channel: str):
        self._messages = redis.pubsub(ignore_subscribe_messages=True)
        self._channel = channel

    def wait(self, seconds: float) -> None:
        """Return after a message, or after some seconds, also while Redis is away."""
        began = time.monotonic()
        try:
            if not self._messages.subscribed:
                self._messages.subscribe(self._channel)
            # The first answer may be the subscription's own.
            while (left := began + seconds - time.monotonic()) > 0:
                if self._messages.get_message(timeout=left):
                    break
            # Several messages count as one. Redis may answer their sender before it writes to
            # its listeners, so the next one can be a moment late.
            while self._messages.get_message(timeout=LATE):
                pass
        except RedisError:
            self.close()
            time.sleep(max(0.0, began + seconds - time.monotonic()))

    def close(self) -> None:
        with suppress(RedisError):
            self._messages.close()
