"""Everything that is looked at, in order."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

from .database import database
from .devices import devices
from .disk import disk
from .finding import Finding, problem
from .memory import memory
from .redis import redis
from .server import server
from .versions import packages, python


def examine(url: str | None, token: str | None, cache: Path) -> Iterator[Finding]:
    """What is found, one thing after another; `cache` is where programs are kept by default.

    What the environment says counts as it does for `make run`.
    """
    data = Path(os.environ.get("MICROCOSMOS_DATA") or "data")
    compiled = Path(os.environ.get("JAX_COMPILATION_CACHE_DIR") or cache)
    database_url = os.environ.get("MICROCOSMOS_DATABASE_URL") or None
    redis_url = os.environ.get("MICROCOSMOS_REDIS_URL") or None
    checks: dict[str, Callable[[], Iterator[Finding]]] = {
        "Python": python,
        "packages": packages,
        "devices": lambda: devices(compiled),
        "memory": memory,
        "disk": lambda: disk(data),
        "Redis": lambda: redis(redis_url),
        "database": lambda: database(database_url, data),
        "server": lambda: server(url, token),
    }
    for subject, check in checks.items():
        yield from _surviving(subject, check)


def _surviving(subject: str, check: Callable[[], Iterator[Finding]]) -> Iterator[Finding]:
    """What keeps one thing from being looked at must not keep the rest from it."""
    try:
        yield from check()
    except Exception as error:
        found = f"it could not be looked at: {type(error).__name__}: {error}"
        yield problem(
            subject, found, "see to that, and tell us where doctor should know better"
        )
