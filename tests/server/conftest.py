"""A real server on a free port, over each database, with a real Redis under its own prefix."""

import base64
import os
import shutil
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache, cached_property
from types import SimpleNamespace
from typing import Any
from uuid import UUID, uuid4

import httpx
import psycopg
import pytest
import uvicorn
from psycopg import sql
from sqlalchemy import make_url, select

from microcosmos.archive import creature
from microcosmos.spec import EXPERIMENTS, parse
from server.app import create_app
from server.local.redis_embedded import prepare
from server.runs.submission import submit
from server.services.services import Services, connect
from server.settings import Settings
from server.tables import Base, Run, migrations

POSTGRESQL = "postgresql://127.0.0.1:5432/postgres"


@contextmanager
def own_postgresql() -> Iterator[str]:
    """A database of PostgreSQL for this process alone, dropped at the end."""
    if given := os.environ.get("MICROCOSMOS_TEST_DATABASE_URL"):
        yield given
        return
    name = f"microcosmos_test_{uuid4().hex[:12]}"
    try:
        connection = psycopg.connect(POSTGRESQL, autocommit=True, connect_timeout=2)
        connection.execute(sql.SQL("CREATE DATABASE {}").format(sql.Identifier(name)))
    except psycopg.Error:
        pytest.skip("no PostgreSQL on 127.0.0.1:5432 where we may create a database")
    database = sql.Identifier(name)
    with connection:
        # What a test wrote need not outlive the machine: nothing waits for the disk.
        connection.execute(
            sql.SQL("ALTER DATABASE {} SET synchronous_commit = off").format(database)
        )
        yield str(make_url(POSTGRESQL).set(database=name))
        connection.execute(sql.SQL("DROP DATABASE {} WITH (FORCE)").format(database))


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request) -> str:
    """The database of a test: `make test` runs it on SQLite alone, unless it is marked."""
    return request.param


@pytest.fixture(scope="session")
def redis_url(tmp_path_factory) -> Iterator[str]:
    """The Redis of this machine, else one of our own."""
    with socket.socket() as probe:
        found = probe.connect_ex(("127.0.0.1", 6379)) == 0
    if found:
        yield "redis://127.0.0.1:6379/0"
        return
    folder = tmp_path_factory.mktemp("redis")
    redis = prepare(folder / "files")
    process = redis.start(folder / "log")
    redis.wait(process, folder / "log")
    yield redis.url
    process.terminate()
    process.wait()


class Installation:
    """An installation for all tests on one database; its server starts when one is needed."""

    def __init__(self, settings: Settings, stack: ExitStack):
        self.services = connect(settings)
        migrations.upgrade(self.services.sessions)
        self._stack = stack
        stack.callback(self.services.close)

    @cached_property
    def address(self) -> str:
        return self._stack.enter_context(running(self.services.settings))

    def clean(self) -> None:
        """Leave nothing to the next test: no row, no key, no file."""
        with self.services.sessions.write.begin() as session:
            for left in session.scalars(select(Run.id)):
                self.services.jobs.forget(str(left))
            for table in reversed(Base.metadata.sorted_tables):
                session.execute(table.delete())
        empty_redis(self.services)
        shutil.rmtree(self.services.settings.artifacts, ignore_errors=True)


@pytest.fixture(scope="session")
def installations(tmp_path_factory, redis_url) -> Iterator[Callable[[str], Installation]]:
    """The installation on a database; its reconciler makes the first pass alone."""
    with ExitStack() as stack:

        @cache
        def install(database: str) -> Installation:
            data = tmp_path_factory.mktemp(database)
            settings = Settings(
                data=data,
                database_url=stack.enter_context(own_postgresql())
                if database == "postgresql"
                else f"sqlite:///{data / 'test.sqlite'}",
                redis_url=redis_url,
                redis_prefix=f"test-{uuid4().hex[:12]}:",
                artifacts_url="",
                max_bytes=1 << 30,
                host="127.0.0.1",
                token=None,
                auth="local",
                lease=20.0,
                grace=15.0,
                reconcile_interval=3600.0,
            )
            return Installation(settings, stack)

        yield install


@pytest.fixture
def installation(installations, database) -> Iterator[Installation]:
    installation = installations(database)
    yield installation
    installation.clean()


@pytest.fixture
def services(installation) -> Services:
    """What a worker would have: the same database, Redis and files as the server."""
    return installation.services


def empty_redis(services: Services) -> None:
    """Remove everything that is ours, as FLUSHALL would."""
    for queue in (*services.jobs.evolving, services.jobs.renderings, services.jobs.audits):
        queue.delete(delete_jobs=True)
    pattern = f"*{services.settings.redis_prefix[:-1]}*"
    if keys := list(services.redis.scan_iter(pattern, count=1000)):
        services.redis.delete(*keys)


@pytest.fixture
def flush(services) -> Callable[[], None]:
    return lambda: empty_redis(services)


@pytest.fixture
def eventually() -> Callable[[Callable[[], Any]], None]:
    """Waits until something is so, and fails where it does not come."""

    def wait(condition: Callable[[], Any]) -> None:
        deadline = time.monotonic() + 20
        while not condition():
            assert time.monotonic() < deadline, "it never came to be"
            time.sleep(0.01)

    return wait


@contextmanager
def running(settings: Settings) -> Iterator[str]:
    """A server in a thread: its address."""
    app = create_app(connect(settings))
    config = uvicorn.Config(app, port=0, log_level="warning", timeout_graceful_shutdown=5)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        assert thread.is_alive(), "the server did not start"
        time.sleep(0.01)
    port = server.servers[0].sockets[0].getsockname()[1]
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        app.state.end_streams()  # As a signal would in the main thread.
        server.should_exit = True
        thread.join()


@pytest.fixture
def serve(services) -> Callable[[], Any]:
    """Starts servers over the same database and Redis, one after another."""
    return lambda **changes: running(services.settings.model_copy(update=changes))


@pytest.fixture
def address(installation) -> str:
    """The server that all tests share."""
    return installation.address


@pytest.fixture
def api(address) -> Iterator[httpx.Client]:
    # Nothing is encrypted here, and reading the authorities' certificates takes its time.
    with httpx.Client(base_url=f"{address}/api/v1/", timeout=20, verify=False) as client:
        yield client


@pytest.fixture
def spec() -> dict[str, Any]:
    return EXPERIMENTS["quality-diversity"].presets[0].spec.model_dump(mode="json")


@pytest.fixture
def run_id(services, spec) -> UUID:
    """A queued run."""
    demo = EXPERIMENTS["quality-diversity"].presets[0].spec
    return submit(services, demo)[0].id


@pytest.fixture
def row(services, run_id) -> Callable[[], Run]:
    """The run as the database has it now."""

    def read() -> Run:
        with services.sessions.read() as session:
            return session.get_one(Run, run_id)

    return read


def little_endian(*values: float) -> str:
    return base64.b64encode(struct.pack(f"<{len(values)}f", *values)).decode()


@pytest.fixture
def identity() -> Callable[[int], dict[str, Any]]:
    """The identity of a swimmer whose one weight is a number."""
    demo = EXPERIMENTS["quality-diversity"].presets[0].spec.model_dump(mode="json")

    def make(number: int = 1) -> dict[str, Any]:
        genome = {
            "encoding": "cppn",
            "inputs": ["position", "sine", "cosine"],
            "outputs": ["rest_angle", "rest_length"],
            "control": demo["control"],
            "nodes": {
                "id": [0, 1, 2, 3, 4],
                "activation": ["identity"] * 5,
                "bias": little_endian(0, 0, 0, 0, 0),
            },
            "connections": {
                "innovation": [0],
                "source": [1],
                "target": [3],
                "enabled": [True],
                "weight": little_endian(number),
            },
        }
        return {
            "format": "microcosmos-creature/1",
            "genome": genome,
            "world": {**demo["world"], "coupling": demo["coupling"]},
            "body": demo["body"],
            "task": demo["task"],
        }

    return make


@pytest.fixture
def sweep() -> dict[str, Any]:
    """The spec of a run whose result is a table."""
    presets = {preset.name: preset.spec for preset in EXPERIMENTS["gaits"].presets}
    return presets["demo"].model_dump(mode="json")


@pytest.fixture
def sweep_id(services, sweep) -> UUID:
    """A queued run whose result is a table."""
    return submit(services, parse(sweep))[0].id


@pytest.fixture
def table(identity) -> Callable[..., Any]:
    """What an experiment without an archive reports of a generation: rows of values."""

    def make(generation: int, *rows: dict[str, Any], summary: Any = None) -> Any:
        return SimpleNamespace(
            generation=generation,
            evaluations=generation,
            diverged=0,
            elites=(),
            rows=tuple(row(values) for values in rows),
            summary=summary,
            **dict.fromkeys(("qd_score", "coverage", "best", "mean")),
        )

    def row(values: dict[str, Any]) -> Any:
        found = identity(values["number"]) if "number" in values else None
        return SimpleNamespace(
            values=values,
            creature=creature.name(found) if found else None,
            identity=creature.canonical(found) if found else None,
            measured=None,
            provenance=None,
        )

    return make


@pytest.fixture
def report(identity) -> Callable[..., Any]:
    """What an experiment reports of a generation: new elites by cell, with their fitness."""

    def make(
        generation: int,
        elites: dict[int, float] | None = None,
        descriptors: tuple[float, ...] = (0.25, 0.5),
        measures: dict[str, float] | None = None,
        summary: dict[str, Any] | None = None,
    ) -> Any:
        found = [
            elite(generation, *item, descriptors, measures or {})
            for item in (elites or {}).items()
        ]
        return SimpleNamespace(
            generation=generation,
            qd_score=10.0 * generation,
            coverage=generation / 256,
            best=float(generation),
            mean=0.5 * generation,
            evaluations=16 * generation,
            diverged=generation,
            elites=tuple(found),
            rows=(),
            summary=summary,
        )

    def elite(
        generation: int,
        cell: int,
        fitness: float,
        descriptors: tuple[float, ...],
        measures: dict[str, float],
    ) -> Any:
        found = identity(1000 * generation + cell)
        return SimpleNamespace(
            cell=cell,
            fitness=fitness,
            descriptors=descriptors,
            creature=creature.name(found),
            identity=creature.canonical(found),
            generation=generation,
            measured={
                "fitness": fitness,
                "descriptors": {"bending_effort": 0.25, "stretching_effort": 0.5},
                "measures": {
                    "displacement": fitness,
                    "bending_effort": 0.25,
                    "stretching_effort": 0.5,
                    **measures,
                },
                "block": 16,
                "room": [24, 64],
                "device": "a device",
            },
            provenance={
                "parents": ["ab" * 32],
                "operator": "neat",
                "generation": generation,
                "seed": 0,
                "version": "0.1.0",
            },
        )

    return make
