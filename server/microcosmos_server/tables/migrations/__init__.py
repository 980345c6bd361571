"""Migrations: bring the tables up to date, and read their revision."""

from functools import cache
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, text

from microcosmos.version import VERSION

from ...core.database import Sessions

LOCK = 0x6D6963726F  # "micro": PostgreSQL's advisory locks are numbers.


class SchemaError(RuntimeError):
    """The tables are not those of this version; the message says what to do."""


def upgrade(sessions: Sessions) -> None:
    """Apply missing migrations in one transaction under a lock: processes may start at once.

    Raise `SchemaError` for tables of a later version.
    """
    writer = sessions.engine.execution_options(writer=True)
    with writer.connect() as connection:
        _prepare(connection)
        with connection.begin():
            # SQLite needs no lock of its own: the transaction of a writer holds it.
            if connection.dialect.name == "postgresql":
                for limit in ("statement_timeout", "lock_timeout"):  # Set for requests.
                    connection.execute(text(f"SET LOCAL {limit} = 0"))
                connection.execute(text(f"SELECT pg_advisory_xact_lock({LOCK})"))
            found = MigrationContext.configure(connection).get_current_revision()
            if found is not None and found not in known():
                raise SchemaError(_later(found))
            command.upgrade(config(connection), "head")


def check(sessions: Sessions) -> None:
    """Raise `alembic.util.CommandError` where tables and models differ."""
    with sessions.engine.connect() as connection:
        command.check(config(connection))


def revision(sessions: Sessions) -> str | None:
    """Return the revision of the tables; None before the first migration."""
    with sessions.engine.connect() as connection:
        return MigrationContext.configure(connection).get_current_revision()


def fault(sessions: Sessions) -> str | None:
    """Return why this version cannot use the tables as they are; None if it can."""
    found = revision(sessions)
    if found == newest():
        return None
    if found is None:
        return "The database has no tables yet; the server makes them when it starts"
    if found not in known():
        return _later(found)
    return (
        f"The tables of the database have revision {found}, and version {VERSION} needs "
        f"{newest()}; the server of this version brings them there when it starts"
    )


def _later(found: str) -> str:
    return (
        f"The tables of the database have revision {found}, which version {VERSION} does not "
        "know; install the version of Microcosmos that made them"
    )


@cache
def known() -> tuple[str, ...]:
    """Return the revisions that this version knows, the newest first."""
    return tuple(one.revision for one in ScriptDirectory.from_config(config()).walk_revisions())


def newest() -> str:
    return known()[0]


def config(connection: Connection | None = None) -> Config:
    """Return Alembic's settings, for a connection whose transaction the caller ends."""
    settings = Config(attributes={"connection": connection})
    settings.set_main_option("script_location", str(Path(__file__).parent).replace("%", "%%"))
    return settings


def _prepare(connection: Connection) -> None:
    """Switch foreign keys off in SQLite: dropping a rebuilt table must not cascade.

    PostgreSQL may take long for a large table, and others may hold the lock.
    """
    driver: Any = connection.connection.dbapi_connection
    if connection.dialect.name == "sqlite":
        driver.execute("PRAGMA foreign_keys=OFF")
    else:
        driver.patience = None
    connection.detach()  # Closed at the end: its settings are not for others.
