"""Migrations: bring the tables up to date, and read their revision."""

from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, text

from ...core.database import Sessions

LOCK = 0x6D6963726F  # "micro": PostgreSQL's advisory locks are numbers.


def upgrade(sessions: Sessions) -> None:
    """Apply missing migrations in one transaction under a lock: processes may start at once."""
    writer = sessions.engine.execution_options(writer=True)
    with writer.connect() as connection:
        _prepare(connection)
        with connection.begin():
            if connection.dialect.name == "postgresql":
                for limit in ("statement_timeout", "lock_timeout"):  # Set for requests.
                    connection.execute(text(f"SET LOCAL {limit} = 0"))
                connection.execute(text(f"SELECT pg_advisory_xact_lock({LOCK})"))
            command.upgrade(config(connection), "head")


def check(sessions: Sessions) -> None:
    """Raise `alembic.util.CommandError` where tables and models differ."""
    with sessions.engine.connect() as connection:
        command.check(config(connection))


def revision(sessions: Sessions) -> str | None:
    """Return the revision of the tables; None before the first migration."""
    with sessions.engine.connect() as connection:
        return MigrationContext.configure(connection).get_current_revision()


def newest() -> str:
    head = ScriptDirectory.from_config(config()).get_current_head()
    assert head is not None
    return head


def config(connection: Connection | None = None) -> Config:
    """Return Alembic's settings, for a connection whose transaction the caller ends."""
    settings = Config(attributes={"connection": connection})
    settings.set_main_option("script_location", str(Path(__file__).parent).replace("%", "%%"))
    return settings


def _prepare(connection: Connection) -> None:
    """Switch foreign keys off in SQLite: dropping a rebuilt table must not cascade."""
    if connection.dialect.name == "sqlite":
        driver: Any = connection.connection.dbapi_connection
        driver.execute("PRAGMA foreign_keys=OFF")
        connection.detach()  # Closed at the end: its settings are not for others.
