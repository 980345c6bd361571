"""A worker's services (a database, a Redis of its own, a queued run) and its supervisor."""

from contextlib import ExitStack

import pytest
import reports
from databases import own_redis
from installation import Installation

from microcosmos_server.runs.submission import submit
from microcosmos_server.schedule.take import take
from microcosmos_server.settings import Settings
from microcosmos_server.tables import Run
from microcosmos_worker.device import Device
from microcosmos_worker.heartbeats import Heartbeats
from microcosmos_worker.plugins import PluginWatcher
from microcosmos_worker.readiness import Readiness
from microcosmos_worker.supervisor import Supervisor


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


@pytest.fixture
def watcher():
    """A watcher of no plug-ins."""
    return PluginWatcher(Settings(modules=""), 0.01)


@pytest.fixture
def heartbeat(services, watcher):
    device = Device("some device", 8 << 30, {}, "0")
    return Heartbeats(services.sessions, "worker", device, lease=20, plugins=watcher)


@pytest.fixture
def busy(services, heartbeat, watcher, monkeypatch, tmp_path):
    """A supervisor that computes on the processor, and that has taken the run."""
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path))
    used = services.settings
    environment = {
        "MICROCOSMOS_DATA": str(used.data),
        "MICROCOSMOS_REDIS_URL": used.redis_url,
        "MICROCOSMOS_REDIS_PREFIX": used.redis_prefix,
    }
    readiness = Readiness(services, Device("a processor", 8 << 30, environment))
    return Supervisor(services, "worker", environment, heartbeat, readiness, watcher)


@pytest.fixture
def next_run(services, heartbeat):
    def next_run():
        heartbeat.beat()
        return take(services, "worker")

    return next_run
