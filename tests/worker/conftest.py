"""A worker's services: a database, a Redis of its own, a queued run."""

from contextlib import ExitStack

import pytest
import reports
from databases import own_redis
from installation import Installation

from server.runs.submission import submit
from server.settings import Settings
from server.tables import Run


@pytest.fixture(scope="session")
def installation(tmp_path_factory):
    """One for all tests, with a Redis of its own."""
    data = tmp_path_factory.mktemp("data")
    with ExitStack() as stack:
        settings = Settings(
            data=data,
            database_url="",
            artifacts_url="",
            redis_url=stack.enter_context(own_redis(tmp_path_factory.mktemp("redis"))),
            redis_prefix="test:",
            checkpoint_interval=0,
            min_free_bytes=0,
        )
        yield Installation(settings, stack)


@pytest.fixture
def services(installation):
    yield installation.services
    installation.clean()
    installation.services.redis.flushdb()


@pytest.fixture
def run_id(services):
    return submit(services, reports.DEMO)[0].id


@pytest.fixture
def row(services, run_id):
    def read():
        with services.sessions.read() as session:
            return session.get_one(Run, run_id)

    return read
