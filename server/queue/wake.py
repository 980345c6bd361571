"""Wake idle workers when a run may wait. A lost message costs them a second."""

import logging
import time
from contextlib import suppress

from redis import Redis, RedisError

log = logging.getLogger(__name__)


class Wake:
    """The channel on which workers are woken."""

    def __init__(self, redis: Redis, prefix: str):
        self._redis, self._channel = redis, f"{prefix}wake"

    def send(self) -> None:
        try:
            self._redis.publish(self._channel, "")
        except RedisError as error:
            log.warning("idle workers find new runs without being woken: %s", error)

    def listen(self) -> "Alarm":
        return Alarm(self._redis, self._channel)


class Alarm:
    """What an idle worker waits for."""

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
            while self._messages.get_message():  # Several messages ask for one look.
                pass
        except RedisError:
            self.close()
            time.sleep(max(0.0, began + seconds - time.monotonic()))

    def close(self) -> None:
        with suppress(RedisError):
            self._messages.close()
