"""The same with PostgreSQL and a Redis that others use too."""

from contextlib import ExitStack

import pytest
from drive import REDIS, interrupt, kill_job, kill_supervisor, stop_worker
from grown_up import Missing, services

pytestmark = pytest.mark.long


@pytest.fixture
def elsewhere():
    """The settings of an installation on this machine's PostgreSQL and Redis."""
    with ExitStack() as stack:
        try:
            settings = stack.enter_context(services())
        except Missing as missing:
            pytest.skip(str(missing))
        yield settings


def test_the_same_bytes_come_from_postgresql_and_a_redis_server_whatever_happens(
    elsewhere, installation, spec, undisturbed
):
    """`undisturbed` is of SQLite and the embedded Redis."""
    place = installation(**elsewhere)
    place.start()
    assert "the one that MICROCOSMOS_REDIS_URL names" in place.output.read_text()
    assert not place.named(REDIS)
    assert not list(place.folder.glob("*.sqlite"))
    run = place.submit(spec)
    interrupt(place, run, [kill_job, kill_supervisor, stop_worker], [1, 4, 7])
    assert place.wait(run, "finished")["attempt"] == 4
    assert place.archive(run) == undisturbed.archive
    assert place.told(run) == undisturbed.told
