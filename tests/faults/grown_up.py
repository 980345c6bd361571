"""PostgreSQL and a Redis server, for an installation that has neither embedded."""

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress

import psycopg
import redis

SERVER = os.environ.get("MICROCOSMOS_TEST_POSTGRESQL", "postgresql://127.0.0.1")
MESSAGES = os.environ.get("MICROCOSMOS_TEST_REDIS", "redis://127.0.0.1:6379")
NAME = f"microcosmos_faults_{os.getpid()}"


class Missing(RuntimeError):
    """Which of them does not answer on this machine."""


@contextmanager
def services() -> Iterator[dict[str, str]]:
    """The settings of an installation on this machine's own; what it left is gone afterwards.

    Raises `Missing` where one of them does not answer.
    """
    with ExitStack() as stack:
        yield {
            "MICROCOSMOS_DATABASE_URL": stack.enter_context(database()),
            "MICROCOSMOS_REDIS_URL": stack.enter_context(messages()),
            "MICROCOSMOS_REDIS_PREFIX": f"{NAME}:",
        }


@contextmanager
def database() -> Iterator[str]:
    """The URL of a new database."""
    try:
        connection = psycopg.connect(f"{SERVER}/postgres", autocommit=True, connect_timeout=2)
    except psycopg.OperationalError as error:
        raise Missing(f"no PostgreSQL answers on this machine: {error}") from None
    with connection:
        connection.execute(f"CREATE DATABASE {NAME}")
        try:
            yield f"{SERVER}/{NAME}"
        finally:
            connection.execute(f"DROP DATABASE {NAME} WITH (FORCE)")


@contextmanager
def messages() -> Iterator[str]:
    """The URL of an unused database of the machine's Redis."""
    for number in range(1, 16):
        url = f"{MESSAGES}/{number}"
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
