"""A real server on a free port, over each database, with a real Redis under its own prefix."""

import inspect
import json
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache
from typing import Any
from uuid import UUID, uuid4

import httpx
import pytest
import reports
from databases import Missing, own_postgresql, own_redis
from installation import GREEDY, Installation, empty_redis, running
from object_store import CREDENTIALS, Proxy, own_object_store
from queueing import alive, reason, taken, waiting  # noqa: F401  (fixtures)
from real_server import started
from sqlalchemy import Connection, event, func, select, update

from microcosmos.archive import creature
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos_server.attempts.attempt import Attempt
from microcosmos_server.attempts.claim import claim
from microcosmos_server.core.database import ago
from microcosmos_server.runs.submission import submit
from microcosmos_server.services import messages
from microcosmos_server.services.services import Services
from microcosmos_server.settings import Settings
from microcosmos_server.tables import Base, InstallationState, Run

# A busy machine answers late; httpx gives up after 5 seconds unless told otherwise.
PATIENCE = inspect.signature(httpx.get).parameters["timeout"].default
PATIENCE.read = PATIENCE.connect = 30.0


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request) -> str:
    """The database of a test: SQLite alone, unless it is marked or its file is repeated."""
    return request.param


@pytest.fixture(scope="session")
def redis_url(tmp_path_factory) -> Iterator[str]:
    """The Redis of this machine, else one of our own."""
    with socket.socket() as probe:
        found = probe.connect_ex(("127.0.0.1", 6379)) == 0
    if found:
        yield "redis://127.0.0.1:6379/0"
        return
    with own_redis(tmp_path_factory.mktemp("redis")) as url:
        yield url


@pytest.fixture(scope="session")
def _object_store() -> Iterator[Proxy]:
    with own_object_store() as proxy:
        yield proxy


@pytest.fixture
def object_store(_object_store, monkeypatch) -> Iterator[Proxy]:
    """An S3 server behind a proxy that can fail, in the environment as that of all stores."""
    for name, value in (CREDENTIALS | {"AWS_ENDPOINT_URL": _object_store.url}).items():
        monkeypatch.setenv(name, value)
    yield _object_store
    _object_store.failing, _object_store.failures = None, 0


@pytest.fixture(scope="session")
def installations(tmp_path_factory, redis_url) -> Iterator[Callable[[str], Installation]]:
    """The installation on a database; its reconciler makes the first pass alone."""
    with ExitStack() as stack:

        @cache
        def install(database: str) -> Installation:
            data = tmp_path_factory.mktemp(database)
            url = f"sqlite:///{data / 'test.sqlite'}"
            if database == "postgresql":
                try:
                    url = stack.enter_context(own_postgresql())
                except Missing as missing:
                    pytest.skip(str(missing))
            settings = Settings(
                data=data,
                database_url=url,
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
                min_free_bytes=0,
            )
            return Installation(settings, stack)

        yield install


@pytest.fixture(autouse=True)
def _no_request_is_greedy() -> Iterator[None]:
    """Whatever a test asks for, the server holds one connection at a time to answer it, and
    none while it waits for the store."""
    yield
    found = GREEDY.found.copy()
    GREEDY.found.clear()
    assert not found, found[0]


@pytest.fixture
def installation(installations, database) -> Iterator[Installation]:
    installation = installations(database)
    yield installation
    installation.clean()


@pytest.fixture
def services(installation) -> Services:
    """A worker's services: the same database, Redis and files as the server."""
    return installation.services


@pytest.fixture
def flush(services) -> Callable[[], None]:
    return lambda: empty_redis(services)


@pytest.fixture
def eventually() -> Callable[[Callable[[], Any]], None]:
    def wait(condition: Callable[[], Any]) -> None:
        deadline = time.monotonic() + 60
        while not condition():
            assert time.monotonic() < deadline, "the condition never held"
            time.sleep(0.01)

    return wait


@pytest.fixture
def serve(services) -> Callable[[], Any]:
    """Starts servers over the same database and Redis, which end with their test."""
    return lambda **changes: running(services.settings.model_copy(update=changes))


@pytest.fixture
def start_server(services, tmp_path) -> Callable[..., Any]:
    """Starts a process that serves the same database and Redis, with settings of its own."""
    settings = services.settings
    same = {
        "MICROCOSMOS_DATA": str(tmp_path),
        "MICROCOSMOS_DATABASE_URL": settings.database_url,
        "MICROCOSMOS_REDIS_URL": settings.redis_url,
        "MICROCOSMOS_REDIS_PREFIX": settings.redis_prefix,
    }
    return lambda **more: started(**same | more)


@pytest.fixture
def served(installation) -> Callable[..., str]:
    """Returns the address of a server with other settings, which all tests share."""
    return installation.served


@pytest.fixture
def address(installation) -> str:
    return installation.served()


@pytest.fixture
def api(address) -> Iterator[httpx.Client]:
    # Nothing is encrypted here, and reading the authorities' certificates takes its time.
    with httpx.Client(base_url=f"{address}/api/v1/", timeout=20, verify=False) as client:
        yield client


@pytest.fixture
def spec() -> dict[str, Any]:
    return reports.DEMO.model_dump(mode="json")


@pytest.fixture
def run_id(services, spec) -> UUID:
    return submit(services, reports.DEMO)[0].id


@pytest.fixture
def claim_run(services, run_id) -> Callable[..., Attempt | None]:
    return lambda worker="worker": claim(services, run_id, worker)


@pytest.fixture
def attempt(claim_run) -> Attempt:
    return claim_run()


@pytest.fixture
def record(request) -> Callable[..., None]:
    """Records a generation of the queued run, as `attempt`; takes what `report` does."""

    def record(*figures: Any, seconds: float = 1.0, **more: Any) -> None:
        attempt = request.getfixturevalue("attempt")
        attempt.record(reports.report(*figures, **more), seconds)

    return record


@pytest.fixture
def update_rows(services) -> Callable[..., None]:
    """Sets columns of a table, in all rows or where some conditions hold."""

    def change(table: type[Base], *where: Any, **values: Any) -> None:
        with services.sessions.write.begin() as session:
            session.execute(update(table).where(*where).values(**values))

    return change


@pytest.fixture
def read_only(services) -> Iterator[Callable[[int], None]]:
    """Lets PostgreSQL refuse to write in the next transactions, as after a failover."""
    engine, left = services.sessions.engine, []

    def refuse(transactions: int) -> None:
        left.extend(range(transactions))

    def begin(connection: Connection) -> None:
        if left:
            left.pop()
            connection.exec_driver_sql("SET TRANSACTION READ ONLY")

    event.listen(engine, "begin", begin)
    yield refuse
    event.remove(engine, "begin", begin)


@pytest.fixture
def silence(services, update_rows) -> Callable[[], None]:
    """Lets the leases of all runs expire."""

    def silence() -> None:
        with services.sessions.read() as session:
            then = ago(session, services.settings.lease + 0.1)
        update_rows(Run, heartbeat_at=then)
        update_rows(InstallationState, reachable_since=None)  # There was no outage.

    return silence


@pytest.fixture
def row(services, run_id) -> Callable[[], Run]:
    def read() -> Run:
        with services.sessions.read() as session:
            return session.get_one(Run, run_id)

    return read


@pytest.fixture
def count(services) -> Callable[[type[Base]], int]:
    def count(table: type[Base]) -> int:
        with services.sessions.read() as session:
            return session.scalar(select(func.count()).select_from(table))

    return count


@pytest.fixture
def statements(services) -> Callable[..., int]:
    """Counts the statements that an action sends to the database."""

    def count(action: Callable[..., Any], *arguments: Any) -> int:
        sent = []

        def note(_connection: Any, _cursor: Any, statement: str, *_: Any) -> None:
            sent.append(statement)

        event.listen(services.sessions.engine, "before_cursor_execute", note)
        action(*arguments)
        event.remove(services.sessions.engine, "before_cursor_execute", note)
        return len(sent)

    return count


@pytest.fixture
def published(services) -> Callable[[], list[tuple[str, Any]]]:
    """Reads all published events, as pairs of kind and data."""

    def read() -> list[tuple[str, Any]]:
        messages.flush()
        entries = services.redis.xrange(services.events.stream)
        return [(e[b"event"].decode(), json.loads(e[b"data"])) for _, e in entries]

    return read


@pytest.fixture
def identity() -> Callable[[int], dict[str, Any]]:
    return reports.identity


@pytest.fixture
def file() -> dict[str, Any]:
    return creature.document(reports.identity(3), None, None)


@pytest.fixture
def upload(api) -> Callable[..., str]:
    """Uploads a creature with an identity, and returns its hash."""

    def upload(identity: dict[str, Any], *more: Any) -> str:
        file = creature.document(identity, *more or (None, None))
        return api.post("creatures", json=file).json()["creature"]

    return upload


@pytest.fixture
def known(api, file) -> str:
    """The hash of a creature that was uploaded."""
    return api.post("creatures", json=file).json()["creature"]


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
def table() -> Callable[..., Any]:
    return reports.table


@pytest.fixture
def report() -> Callable[..., Any]:
    return reports.report
