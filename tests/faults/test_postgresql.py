"""The same with PostgreSQL and a Redis that others use too."""

import os
from contextlib import suppress

import psycopg
import pytest
import redis
from drive import interrupt, kill_job, kill_supervisor, stop_worker

SERVER = "postgresql://127.0.0.1"
NAME = f"microcosmos_faults_{os.getpid()}"


@pytest.fixture
def database():
    """The URL of a new database, gone afterwards."""
    try:
        connection = psycopg.connect(f"{SERVER}/postgres", autocommit=True, connect_timeout=2)
    except psycopg.OperationalError as error:
        pytest.skip(f"no PostgreSQL answers on this machine: {error}")
    with connection:
        connection.execute(f"CREATE DATABASE {NAME}")
        yield f"{SERVER}/{NAME}"
        connection.execute(f"DROP DATABASE {NAME} WITH (FORCE)")
    connection.close()


@pytest.fixture
def messages():
    """The URL of an unused database of the machine's Redis, emptied afterwards."""
    for number in range(1, 16):
        url = f"redis://127.0.0.1:6379/{number}"
        with suppress(redis.RedisError), redis.Redis.from_url(url) as client:
            if not client.dbsize():
                yield url
                client.flushdb()
                return
    pytest.skip("no Redis with an unused database answers on this machine")


def test_faults_change_no_byte_on_postgresql_either(
    installation, spec, undisturbed, database, messages
):
    place = installation(
        MICROCOSMOS_DATABASE_URL=database,
        MICROCOSMOS_REDIS_URL=messages,
        MICROCOSMOS_REDIS_PREFIX=f"{NAME}:",
    )
    place.start()
    run = place.submit(spec)
    interrupt(place, run, [kill_job, kill_supervisor, stop_worker], [1, 4, 7])
    assert place.wait(run, "finished")["attempt"] == 4
    assert place.archive(run) == undisturbed.archive
    assert place.told(run) == undisturbed.told
    place.close()
