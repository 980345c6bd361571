"""Copies of a database in use: SQLite's online backup, and pg_dump."""

import os
import shutil
import sqlite3
import subprocess
from contextlib import closing
from pathlib import Path

from sqlalchemy import Engine, select, text

from ..storage.artifacts import StoredFile
from ..tables import Artifact

NAMED = select(Artifact.path, Artifact.size, Artifact.sha256).order_by(Artifact.path)
"""The files that a database names."""


class DumpError(RuntimeError):
    """The database cannot be copied; the message says why."""


def save(engine: Engine, file: Path) -> list[StoredFile]:
    """Copy a database as it is now; return the files that the copy names."""
    if engine.dialect.name == "sqlite":
        return _save_sqlite(engine, file)
    with engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        # The snapshot is shared until the dump has begun, however slowly.
        connection.execute(text("SET LOCAL idle_in_transaction_session_timeout = 0"))
        snapshot = connection.execute(text("SELECT pg_export_snapshot()")).scalar_one()
        named = [StoredFile(*row) for row in connection.execute(NAMED)]
        _run(engine, "pg_dump", f"--snapshot={snapshot}", "--format=custom", f"--file={file}")
    return named


def load(engine: Engine, file: Path) -> None:
    """Fill an empty database with a copy."""
    if engine.dialect.name == "sqlite":
        _copy_sqlite(file, Path(str(engine.url.database)))
        return
    _run(engine, "pg_restore", "--exit-on-error", "--single-transaction", str(file))


def _save_sqlite(engine: Engine, file: Path) -> list[StoredFile]:
    _copy_sqlite(Path(str(engine.url.database)), file)
    with closing(sqlite3.connect(file)) as copy:
        copy.execute("PRAGMA journal_mode=DELETE")  # One file, without a log beside it.
        columns = "path, size, lower(hex(sha256))"
        rows = copy.execute(f"SELECT {columns} FROM artifacts ORDER BY path").fetchall()
    return [StoredFile(*row) for row in rows]


def _copy_sqlite(source: Path, target: Path) -> None:
    with closing(sqlite3.connect(source)) as there, closing(sqlite3.connect(target)) as copy:
        there.backup(copy)


def _run(engine: Engine, program: str, *options: str) -> None:
    """Run a program of PostgreSQL. Every user can read arguments, so they have no password."""
    if shutil.which(program) is None:
        raise DumpError(f"{program} of PostgreSQL must be on PATH; it was not found")
    url = engine.url.set(drivername="postgresql", password=None)
    command = [program, "--no-owner", "--no-privileges", *options]
    command += [f"--dbname={url.render_as_string()}"]
    password = {"PGPASSWORD": str(engine.url.password)} if engine.url.password else {}
    done = subprocess.run(command, env=os.environ | password, capture_output=True, text=True)
    if done.returncode:
        raise DumpError(f"{program} failed: {done.stderr.strip()[-1000:]}")
