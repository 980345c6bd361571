"""The database: does it answer, and are its tables those of this version?"""

import re
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

from .finding import Finding, ok, problem, warning

QUERY = "SELECT version_num FROM alembic_version"
OLDEST = (3, 35)
"""The first SQLite that answers an UPDATE with its rows."""
MIGRATIONS = Path(__file__).parents[3] / "server" / "tables" / "migrations" / "versions"
"""Where they are in a checkout; an installed library has none."""
CHOSEN = "correct MICROCOSMOS_DATABASE_URL; without it SQLite in the data folder is used"


def database(url: str | None, data: Path, migrations: Path = MIGRATIONS) -> Iterator[Finding]:
    """The one that is named, else SQLite in the data folder."""
    newest = head(migrations)
    scheme = urlsplit(url or "sqlite").scheme.partition("+")[0]
    if scheme == "postgresql":
        assert url is not None
        yield from _postgresql(url, newest)
    elif url is None or scheme == "sqlite":
        named = Path((url or "").partition(":///")[2] or data / "microcosmos.sqlite")
        yield from _sqlite(named, newest)
    else:
        yield problem("database", f"{scheme} is no database that is known", CHOSEN)


def _sqlite(path: Path, newest: str | None) -> Iterator[Finding]:
    if sqlite3.sqlite_version_info < OLDEST:
        told = f"SQLite {sqlite3.sqlite_version}"
        yield problem("database", told, "use a Python with SQLite 3.35 or newer, or PostgreSQL")
        return
    where = f"SQLite {sqlite3.sqlite_version} at {path}"
    if not path.exists():
        yield ok("database", f"{where}: not there yet; the first start makes it")
        return
    try:
        uri = f"file:{quote(str(path.resolve()))}?mode=ro"
        with closing(sqlite3.connect(uri, uri=True, timeout=5)) as connection:
            row = connection.execute(QUERY).fetchone()
    except sqlite3.Error as error:
        yield problem(
            "database",
            f"{where}: {error}",
            "stop all servers, keep a copy of the file, and see whether sqlite3 can recover it",
        )
        return
    yield _judged(where, row[0] if row else None, newest)


def _postgresql(url: str, newest: str | None) -> Iterator[Finding]:
    place = urlsplit(url)
    where = f"PostgreSQL at {place.hostname or 'a socket'}{place.path}"  # Without a password.
    if find_spec("psycopg") is None:
        advice = "pip install 'psycopg[binary]', to have it asked"
        yield warning("database", f"{where} is not asked", advice)
        return
    psycopg: Any = import_module("psycopg")
    plain = re.sub(r"^postgresql\+\w+", "postgresql", url)
    try:
        with psycopg.connect(plain, connect_timeout=5) as connection:
            row = connection.execute(QUERY).fetchone()
    except psycopg.errors.UndefinedTable:
        yield ok("database", f"{where}: no tables yet; the first start makes them")
        return
    except psycopg.Error as error:
        told = " ".join(str(error).split())
        yield problem("database", f"{where} does not answer: {told}", f"start it, or {CHOSEN}")
        return
    yield _judged(where, row[0] if row else None, newest)


def _judged(where: str, found: str | None, newest: str | None) -> Finding:
    """Whether the tables are those of this version."""
    told = f"{where}, tables of migration {found}"
    if newest is None or found == newest:
        return ok("database", told)
    if found is None or found < newest:
        advice = "nothing: the next start of the server brings it up to date"
        return warning("database", f"{told}; {newest} is the newest", advice)
    return problem(
        "database",
        f"{told}; this version knows them up to {newest}",
        "a newer Microcosmos was here: use that one, or another data folder",
    )


def head(migrations: Path) -> str | None:
    """The newest migration of a checkout: the one that no other follows."""
    texts = [path.read_text("utf-8") for path in migrations.glob("*.py")]
    own = {m[1] for text in texts if (m := re.search(r'^revision = "(\w+)"', text, re.M))}
    followed = {
        m[1] for text in texts if (m := re.search(r'^down_revision = "(\w+)"', text, re.M))
    }
    return max(own - followed, default=None)
