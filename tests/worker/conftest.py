"""A worker's surroundings: a database, an own Redis, a queued run, reports to record."""

from types import SimpleNamespace

import pytest

from microcosmos.spec import EXPERIMENTS
from server.local import redis_embedded
from server.runs.submission import submit
from server.services.services import connect
from server.settings import Settings
from server.tables import Run, migrations


@pytest.fixture(scope="session")
def redis_url(tmp_path_factory):
    folder = tmp_path_factory.mktemp("redis")
    redis = redis_embedded.prepare(folder / "files")
    process = redis.start(folder / "log")
    redis.wait(process, folder / "log")
    yield redis.url
    process.terminate()
    process.wait()


@pytest.fixture
def settings(tmp_path, redis_url):
    return Settings(
        data=tmp_path,
        database_url="",
        artifacts_url="",
        redis_url=redis_url,
        redis_prefix="test:",
        checkpoint_interval=0,
    )


@pytest.fixture
def services(settings):
    services = connect(settings)
    migrations.upgrade(services.sessions)
    yield services
    services.redis.flushdb()
    services.close()


@pytest.fixture
def run_id(services):
    """A queued run."""
    return submit(services, EXPERIMENTS["quality-diversity"].presets[0].spec)[0].id


@pytest.fixture
def row(services, run_id):
    """The run as the database has it now."""

    def read():
        with services.sessions.read() as session:
            return session.get_one(Run, run_id)

    return read


@pytest.fixture
def report():
    """What an experiment tells about a generation in which no cell changed."""

    def make(generation):
        return SimpleNamespace(
            generation=generation,
            qd_score=1.0,
            coverage=0.5,
            best=1.0,
            mean=1.0,
            evaluations=16 * generation,
            diverged=0,
            elites=(),
            rows=(),
            summary=None,
        )

    return make
