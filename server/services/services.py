"""Services of server and workers: database, queues, events, files; FastAPI dependencies."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from redis import Redis
from sqlalchemy.orm import Session

from ..core import database
from ..core.database import Sessions
from ..queue.jobs import Jobs, open_redis
from ..queue.wake import Wake
from ..settings import Settings
from ..storage.artifacts import Artifacts
from .event_stream import Events


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
        self.redis.close()
        self.sessions.engine.dispose()


def connect(settings: Settings) -> Services:
    """Create all services; they connect at their first use."""
    redis = open_redis(settings.redis_url)
    return Services(
        settings=settings,
        sessions=database.connect(settings.database),
        redis=redis,
        jobs=Jobs(redis, settings.redis_prefix),
        wake=Wake(redis, settings.redis_prefix),
        events=Events(redis, settings.redis_prefix),
        artifacts=Artifacts(settings.artifacts),
    )


def _services(request: Request) -> Services:
    return request.app.state.services


ServicesDep = Annotated[Services, Depends(_services)]


def _session(services: ServicesDep) -> Iterator[Session]:
    with services.sessions.read() as session:
        yield session


# Closed before the answer is sent: a long download must not hold a connection.
SessionDep = Annotated[Session, Depends(_session, scope="function")]
