"""The event stream: publish events to Redis; the server sends them to its clients."""

import json
import logging
from typing import Any
from uuid import UUID

from redis import Redis, RedisError

STREAM_LENGTH = 10_000
"""Approximate length of the stream. A client that missed more fetches everything."""

log = logging.getLogger(__name__)


class Events:
    """The stream that the server and all workers write to."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.stream = f"{prefix}events"

    def publish(self, kind: str, run_id: UUID, data: dict[str, Any]) -> None:
        """Publish an event, if Redis answers."""
        fields = {"event": kind, "run": str(run_id), "data": json.dumps(data, allow_nan=False)}
        try:
            self.redis.xadd(self.stream, fields, maxlen=STREAM_LENGTH, approximate=True)  # pyright: ignore
        except RedisError as error:
            # SQL holds the content of the event, and pages fetch it when Redis is back.
            log.warning("no event %s of run %s: %s", kind, run_id, error)

    def forget(self, seconds: float) -> None:
        """Delete events that are older; a client that missed them fetches everything."""
        now: Any = self.redis.time()
        oldest = int(1000 * (now[0] - seconds))
        self.redis.xtrim(self.stream, minid=f"{max(0, oldest)}", approximate=False)
