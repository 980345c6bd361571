"""Services of server and workers: database, queues, events and files."""

from dataclasses import dataclass

from redis import Redis

from ..core import database
from ..core.database import Sessions
from ..queue.jobs import Jobs, open_redis
from ..settings import Settings
from ..storage.artifacts import Artifacts
from .event_stream import Events


@dataclass(frozen=True)
class Services:
    settings: Settings
    sessions: Sessions
    redis: Redis
    jobs: Jobs
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
        events=Events(redis, settings.redis_prefix),
        artifacts=Artifacts(settings.artifacts),
    )
