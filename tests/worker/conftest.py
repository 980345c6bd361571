"""A worker's surroundings: a database, an own Redis, a queued run, reports to record."""

from contextlib import ExitStack
from types import SimpleNamespace

import pynvml
import pytest
import reports
from databases import own_redis
from installation import Installation

from microcosmos.spec import EXPERIMENTS
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
        )
        yield Installation(settings, stack)


@pytest.fixture
def services(installation):
    yield installation.services
    installation.clean()
    installation.services.redis.flushdb()


@pytest.fixture
def settings(services):
    return services.settings


@pytest.fixture
def run_id(services):
    return submit(services, EXPERIMENTS["quality-diversity"].presets[0].spec)[0].id


@pytest.fixture
def row(services, run_id):
    def read():
        with services.sessions.read() as session:
            return session.get_one(Run, run_id)

    return read


@pytest.fixture
def report():
    return reports.report


@pytest.fixture
def nvml(monkeypatch):
    """A function that replaces NVIDIA's library by one that knows some cards.

    `cards` has name and memory by UUID, None for a card that fails; None is no driver. `parts`
    has the same for the parts of divided cards.
    """

    def install(cards, parts=None, used=0, load=None):
        parts = parts or {}
        every = {**(cards or {}), **{k: v for some in parts.values() for k, v in some.items()}}

        def known(value):
            if value is None:
                raise pynvml.NVMLError(pynvml.NVML_ERROR_NOT_SUPPORTED)
            return value

        def memory(uuid):
            return SimpleNamespace(total=known(every[uuid])[1], used=known(used))

        answers = {
            "nvmlInit": lambda: known(cards),
            "nvmlShutdown": lambda: None,
            "nvmlDeviceGetCount": lambda: len(cards),
            "nvmlDeviceGetHandleByIndex": lambda i: list(cards)[i],
            "nvmlDeviceGetHandleByUUID": lambda uuid: uuid,
            "nvmlDeviceGetUUID": lambda uuid: uuid,
            "nvmlDeviceGetName": lambda uuid: known(every[uuid])[0],
            "nvmlDeviceGetMemoryInfo": memory,
            "nvmlDeviceGetUtilizationRates": lambda _: SimpleNamespace(gpu=known(load)),
            "nvmlDeviceGetMigMode": lambda uuid: (known(parts.get(uuid)) and 1, 1),
            "nvmlDeviceGetMaxMigDeviceCount": lambda _: 7,
            "nvmlDeviceGetMigDeviceHandleByIndex": lambda uuid, i: known(
                dict(enumerate(parts[uuid])).get(i)
            ),
        }
        for name, answer in answers.items():
            monkeypatch.setattr(pynvml, name, answer)

    return install
