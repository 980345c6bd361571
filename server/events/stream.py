"""What happens, told to everybody who watches: a Redis stream that the server fans out."""

import json
import logging
import math
from typing import Any
from uuid import UUID

from redis import Redis, RedisError

KEPT = 10_000
"""Events that a stream keeps, about; who has missed more fetches everything anew."""

log = logging.getLogger(__name__)


class Events:
    """The stream that the server and all workers write to."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.stream = f"{prefix}events"

    def publish(self, kind: str, run_id: UUID, data: dict[str, Any]) -> None:
        """Tell it, if Redis answers."""
        fields = {"event": kind, "run": str(run_id), "data": json.dumps(data, allow_nan=False)}
        try:
            self.redis.xadd(self.stream, fields, maxlen=KEPT, approximate=True)  # pyright: ignore
        except RedisError as error:
            # An event is a courtesy: what it tells is in SQL already, and a run of days must
            # not end because nobody could be told. Pages fetch anew when Redis is back.
            log.warning("no event %s of run %s: %s", kind, run_id, error)


def finite(value: float | None) -> float | None:
    """JSON and SQL know no NaN and no infinity: None."""
    return value if value is not None and math.isfinite(value) else None
