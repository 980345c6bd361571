"""The database: engine, sessions, clock, inserts that tolerate existing rows, and retries."""

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar, cast

import psycopg
from psycopg.errors import _WaitTimeout
from sqlalchemy import URL, DateTime, Engine, ExceptionContext, create_engine, event, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import OperationalError
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import Session, sessionmaker
from sqlalchemy.sql.expression import FunctionElement
from sqlalchemy.types import TypeDecorator

from ..settings import create_private

TIMEOUT_MS = 15_000
KEPT_CONNECTIONS, MAX_CONNECTIONS = 5, 20
"""Connections that a process keeps open, and the most that it uses at once."""
REQUEST_CONNECTIONS = 10
"""The most requests that hold a session while they wait for a thread. Else all connections
could wait for threads, and all threads for connections. Threads of `core.answers` may hold five
more."""
POOL = {"pool_size": KEPT_CONNECTIONS, "max_overflow": MAX_CONNECTIONS - KEPT_CONNECTIONS}
STATEMENT_SECONDS = 4 * TIMEOUT_MS / 1000
"""Longest time of a statement, which PostgreSQL itself ends."""
SILENT_SECONDS = STATEMENT_SECONDS + 5
"""Seconds after which a PostgreSQL that says nothing, not even that, does not answer."""
RETRY_SECONDS = 1.0
AWAY = ("25006", "25P03", "25P04")
"""States of PostgreSQL that its driver does not take for an outage: it is read-only, as after a
failover or with a full disk, or it has ended a transaction that took too long."""

F = TypeVar("F", bound=Callable[..., Any])
log = logging.getLogger(__name__)


class Moment(TypeDecorator[datetime]):
    """A point in time, in UTC on every database."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Any) -> datetime | None:
        return value.astimezone(UTC) if value else None

    def process_result_value(self, value: datetime | None, dialect: Any) -> datetime | None:
        if value is None or value.tzinfo:
            return value
        return value.replace(tzinfo=UTC)  # SQLite keeps no zone.


class clock(FunctionElement[datetime]):
    """The clock of the database, which decides all leases and expiries."""

    type = Moment()
    inherit_cache = True


@compiles(clock, "sqlite")
def _sqlite_clock(element: clock, compiler: Any, **_: Any) -> str:
    # SQLite counts milliseconds. The zeros make the text as long as those that SQLAlchemy
    # writes: SQLite compares moments as texts.
    return "strftime('%Y-%m-%d %H:%M:%f000', 'now')"


@compiles(clock, "postgresql")
def _postgresql_clock(element: clock, compiler: Any, **_: Any) -> str:
    # `now()` stands still during a transaction, which may have waited for a lock.
    return "clock_timestamp()"


def now(session: Session) -> datetime:
    return session.execute(select(clock())).scalar_one()


def ago(session: Session, seconds: float) -> datetime:
    return now(session) - timedelta(seconds=seconds)


def insert_missing(session: Session, table: Any, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert rows, except those whose key exists already."""
    if rows:
        session.execute(_insert(session, table).on_conflict_do_nothing(), rows)


def insert_or_update(
    session: Session,
    table: Any,
    rows: Sequence[Mapping[str, Any]],
    keys: Sequence[str],
    values: Mapping[str, Any],
) -> None:
    """Insert rows; where a key exists already, set `values` instead."""
    statement = _insert(session, table)
    session.execute(statement.on_conflict_do_update(index_elements=keys, set_=values), rows)


def _insert(session: Session, table: Any) -> Any:
    postgres = session.get_bind().dialect.name == "postgresql"
    return (postgresql if postgres else sqlite).insert(table)


class Sessions:
    """Sessions that read, and sessions that write: `with sessions.write.begin() as session:`.

    On SQLite a writer takes the lock at its start: SQLite refuses a write from a reader if
    another session has written since.
    """

    def __init__(self, engine: Engine):
        self.engine = engine
        self.read = sessionmaker(engine, expire_on_commit=False)
        self.write = sessionmaker(engine.execution_options(writer=True), expire_on_commit=False)


def connect(url: URL) -> Sessions:
    """Open a database; create the folder of an SQLite file."""
    return Sessions(_sqlite(url) if url.get_backend_name() == "sqlite" else _postgresql(url))


class PatientConnection(psycopg.Connection[Any]):
    """A connection that is closed if PostgreSQL is silent for long, as when it is frozen."""

    patience: float | None = SILENT_SECONDS

    def wait(self, gen: Any, interval: float = 0.1, timeout: float | None = None) -> Any:
        try:
            return super().wait(gen, interval, timeout or self.patience)
        except _WaitTimeout:
            self.close()
            raise psycopg.OperationalError(f"no answer for {self.patience:g} s") from None


# A machine that is gone answers no probe either: its connections end after some 30 seconds.
PROBES = {"keepalives_idle": 10, "keepalives_interval": 5, "keepalives_count": 4}
PROBES |= {"tcp_user_timeout": 30_000}


def _postgresql(url: URL) -> Engine:
    # A writer whose machine freezes must not keep its rows locked.
    idle = f"-c idle_in_transaction_session_timeout={2 * TIMEOUT_MS}"
    statement = f"-c statement_timeout={STATEMENT_SECONDS * 1000:.0f}"
    limits = f"{statement} -c lock_timeout={TIMEOUT_MS} {idle}"
    engine = create_engine(
        url.set(drivername="postgresql+psycopg"),
        # A restart of PostgreSQL closes the connections that the pool keeps.
        pool_pre_ping=True,
        **POOL,
        connect_args={
            "connect_timeout": 10,
            "options": f"-c timezone=UTC {limits}",
            **PROBES,
        },
    )

    @event.listens_for(engine, "do_connect")
    def connect(_: Any, __: Any, arguments: Any, names: Any) -> psycopg.Connection[Any]:  # pyright: ignore
        return PatientConnection.connect(*arguments, **names)

    @event.listens_for(engine, "handle_error", retval=True)
    def away(context: ExceptionContext) -> OperationalError | None:  # pyright: ignore
        error = context.original_exception
        if not isinstance(error, psycopg.Error) or error.sqlstate not in AWAY:
            return None
        # Whoever tries again shall reach the server that has taken over.
        context.is_disconnect = True
        return OperationalError(context.statement, context.parameters, error)

    return engine


def _sqlite(url: URL) -> Engine:
    create_private(Path(str(url.database)).parent)
    engine = create_engine(url, connect_args={"timeout": TIMEOUT_MS / 1000}, **POOL)
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def _prepare_sqlite(connection: Any, _: Any) -> None:
    connection.isolation_level = None  # The driver begins nothing by itself.
    # SQLite's own `lower` handles ASCII alone.
    connection.create_function(
        "lower", 1, lambda text: text and text.lower(), deterministic=True
    )
    # With WAL readers and the writer do not wait for each other. With NORMAL a power cut may
    # cost the last transactions, and never damages the file (sqlite.org/wal.html).
    for pragma in (
        f"busy_timeout={TIMEOUT_MS}",
        "journal_mode=WAL",
        "synchronous=NORMAL",
        "foreign_keys=ON",
    ):
        connection.execute(f"PRAGMA {pragma}")


def _begin_sqlite(connection: Any) -> None:
    writer = connection.get_execution_options().get("writer")
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writer else "BEGIN")


def retried(method: F) -> F:
    """Retry a method of an attempt while the database is away, for its `outage_seconds`.

    Stop at once if its worker must stop.
    """

    @wraps(method)
    def repeat(attempt: Any, *args: Any, **kwargs: Any) -> Any:
        deadline = time.monotonic() + attempt.outage_seconds
        while True:
            try:
                return method(attempt, *args, **kwargs)
            except OperationalError as error:
                if time.monotonic() >= deadline or attempt.stop_requested():
                    raise
                log.warning("Waiting for the database: %s", error)
                time.sleep(RETRY_SECONDS)

    return cast(F, repeat)
