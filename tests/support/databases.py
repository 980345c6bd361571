"""Databases and Redis servers for tests, deleted afterwards."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

import psycopg
import redis

from microcosmos_server.local.redis_embedded import prepare

POSTGRES = os.environ.get("MICROCOSMOS_TEST_POSTGRESQL", "postgresql://127.0.0.1:5432")
REDIS = os.environ.get("MICROCOSMOS_TEST_REDIS", "redis://127.0.0.1:6379")


class Missing(RuntimeError):
    """No such service answers on this machine."""


@contextmanager
def own_postgresql() -> Iterator[str]:
    """A new database of this machine's PostgreSQL; raises `Missing` without one."""
    name = f"microcosmos_test_{uuid4().hex[:12]}"
    try:
        connection = psycopg.connect(f"{POSTGRES}/postgres", autocommit=True, connect_timeout=2)
        connection.execute(f"CREATE DATABASE {name}")
    except psycopg.Error as error:
        raise Missing(f"no PostgreSQL at {POSTGRES} where we may create a database") from error
    with connection:
        # The data need not outlive the machine, so nothing waits for the disk.
        connection.execute(f"ALTER DATABASE {name} SET synchronous_commit = off")
        try:
            yield f"{POSTGRES}/{name}"
        finally:
            connection.execute(f"DROP DATABASE {name} WITH (FORCE)")


@contextmanager
def own_redis(folder: Path) -> Iterator[str]:
    """A new Redis server, with its files in a folder."""
    server = prepare(folder / "files")
    process = server.start(folder / "log")
    server.wait(process, folder / "log")
    yield server.url
    process.terminate()
    process.wait()


@contextmanager
def unused_redis() -> Iterator[str]:
    """An unused database of this machine's Redis; raises `Missing` without one."""
    for number in range(1, 16):
        url = f"{REDIS}/{number}"
        with suppress(redis.RedisError), redis.Redis.from_url(url) as client:
            if not client.dbsize():
                break
    else:
        raise Missing("no Redis with an unused database answers on this machine")
    with redis.Redis.from_url(url) as client:
        try:
            yield url
        finally:
            client.flushdb()


@contextmanager
def service_settings() -> Iterator[dict[str, str]]:
    """The settings of an installation on this machine's PostgreSQL and Redis."""
    with own_postgresql() as database, unused_redis() as messages:
        yield {
            "MICROCOSMOS_DATABASE_URL": database,
            "MICROCOSMOS_REDIS_URL": messages,
            "MICROCOSMOS_REDIS_PREFIX": f"microcosmos_faults_{os.getpid()}:",
        }
