"""Services of server and workers: database, queues, events, files; FastAPI dependencies."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from redis import Redis
from sqlalchemy.orm import Session

from ..core import database
from ..core.database import REQUEST_CONNECTIONS, Sessions
from ..queue.jobs import ANSWER_SECONDS, Jobs, open_redis
from ..settings import Settings
from ..storage.artifacts import Artifacts
from .messages import Events, Wake

MESSAGE_SECONDS = 5.0
"""Seconds that the thread waits which sends messages; nobody waits for it."""


@dataclass(frozen=True)
class Services:
    settings: Settings
    sessions: Sessions
    redis: Redis
    jobs: Jobs
    wake: Wake
    events: Events
    artifacts: Artifacts

    def close(self) -> None:
        self.events.messenger.end()
        self.events.redis.close()
        self.redis.close()
        self.sessions.engine.dispose()


def connect(settings: Settings, patience: float = ANSWER_SECONDS) -> Services:
    """Create all services; they connect at their first use.

    `patience` is how many seconds to wait for an answer of Redis.
    """
    redis = open_redis(settings.redis_url, patience)
    events = Events(open_redis(settings.redis_url, MESSAGE_SECONDS), settings.redis_prefix)
    return Services(
        settings=settings,
        sessions=database.connect(settings.database),
        redis=redis,
        jobs=Jobs(redis, settings.redis_prefix),
        wake=Wake(redis, settings.redis_prefix, events.messenger),
        events=events,
        artifacts=Artifacts(settings.artifacts),
    )


def _services(request: Request) -> Services:
    return request.app.state.services


ServicesDep = Annotated[Services, Depends(_services)]


def _session(services: ServicesDep) -> Iterator[Session]:
    with services.sessions.read() as session:
        yield session


# Closed before the answer is sent: a long download must not hold a connection. A request waits
# for its turn without a thread. A route that reads files or waits for Redis must not take it:
# others would wait, too (tests/server/core/test_http.py).
SessionDep = Annotated[
    Session, Depends(_session, scope="function", max_concurrency=REQUEST_CONNECTIONS)
]
