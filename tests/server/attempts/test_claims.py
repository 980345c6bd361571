"""The fence: what one attempt writes, no other attempt can."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from sqlalchemy import update
from sqlalchemy.exc import OperationalError

from server.attempts import leases
from server.attempts.attempt import Attempt, ClaimLost
from server.attempts.claim import claim
from server.core.database import ago
from server.runs import announce, lifecycle
from server.tables import Elite, Generation, Run

pytestmark = pytest.mark.postgresql


def silence(services, run_id):
    """The last heartbeat was a lease ago, and a little more, as if the worker were frozen."""
    with services.sessions.write.begin() as session:
        then = ago(session, services.settings.lease + 0.1)
        session.execute(update(Run).values(heartbeat_at=then).where(Run.id == run_id))


def test_one_of_many_concurrent_claims_succeeds(services, run_id):
    with ThreadPoolExecutor(8) as pool:
        names = [f"worker {number}" for number in range(8)]
        claims = list(pool.map(lambda name: claim(services, run_id, name), names))
    (held,) = (found for found in claims if found)
    assert held.number == 1
    assert claim(services, run_id, "another") is None


def test_a_silent_workers_run_is_claimed_and_its_writes_refused(
    services, run_id, report, count
):
    first = claim(services, run_id, "first")
    first.record(report(1, {0: 1.0}), 1.0)
    silence(services, run_id)
    second = claim(services, run_id, "second")
    assert second.number == 2
    writes = (
        lambda: first.record(report(2), 1.0),
        lambda: first.save(1, b"data"),
        lambda: first.warn("text"),
        first.check,
        first.finish,
        first.pause,
        first.requeue,
        lambda: first.fail("error"),
    )
    for write in writes:
        with pytest.raises(ClaimLost):
            write()
    second.record(report(1, {0: 1.0}), 1.0)
    assert second.requested_state is None
    assert count(Generation) == 1


def test_a_generation_is_recorded_once_or_not_at_all(report, attempt, record, count):
    broken = report(1, {1: 1.0})
    broken.elites[0].creature = "00" * 32  # Of which there is no creature.
    broken.elites[0].identity = None
    with pytest.raises(Exception, match=r"(?i)null"):
        attempt.record(broken, 1.0)
    assert count(Generation) == count(Elite) == 0
    assert attempt.seconds == 0
    record(1, {1: 1.0})


def test_a_finished_run_forgets_errors_and_numbers_that_are_not_finite(
    services, run_id, report, row
):
    claim(services, run_id, "worker").fail("error")
    attempt = claim(services, run_id, "worker")
    nothing = report(1)
    nothing.best, nothing.mean = float("-inf"), float("nan")
    attempt.record(nothing, 1.0)
    assert row().best is None
    attempt.finish()
    assert (row().status, row().error) == ("finished", None)


def test_a_lease_is_renewed_by_its_holder(services, run_id, row):
    def beat(worker):
        return leases.heartbeat(services.sessions, run_id, worker)

    assert beat("first") == "waiting"
    attempt = claim(services, run_id, "first")
    before = row().heartbeat_at
    assert beat("first") == "held"
    assert row().heartbeat_at >= before
    assert beat("second") == "lost"
    attempt.finish()
    assert beat("first") == "over"


def test_redis_can_be_away_while_a_run_is_recorded(services, run_id, report, row, monkeypatch):
    from redis import ConnectionError

    def away(*_, **__):
        raise ConnectionError("Connection refused")

    monkeypatch.setattr(services.redis, "xadd", away)
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, {1: 1.0}), 1.0)
    attempt.finish()
    assert row().status == "finished"


def test_resuming_a_waiting_run_allows_another_device(services, run_id):
    first = claim(services, run_id, "first")
    assert not first.other_device
    first.wait_for_override("it began elsewhere")
    with services.sessions.write.begin() as session:
        run = session.get_one(Run, run_id)
        assert run.status == "paused"
        assert run.warning.startswith("it began elsewhere Resume the run to continue")
        lifecycle.resume(session, run)
    assert claim(services, run_id, "second").other_device


def test_resuming_an_ordinary_run_allows_no_other_device(services, run_id):
    claim(services, run_id, "first").pause()
    with services.sessions.write.begin() as session:
        lifecycle.resume(session, session.get_one(Run, run_id))
    assert not claim(services, run_id, "second").other_device


@pytest.mark.parametrize("end", [Attempt.pause, lambda held: held.wait_for_override("why")])
def test_a_cancellation_overrides_a_pause_under_way(services, run_id, row, end, attempt):
    with services.sessions.write.begin() as session:
        lifecycle.cancel(session, session.get_one(Run, run_id))
    end(attempt)
    assert (row().status, row().requested_state) == ("cancelled", None)
    assert row().finished_at is not None


def test_a_committed_generation_is_not_written_twice(row, attempt, record, count):
    record(1, {1: 1.0}, seconds=2.0)
    attempt.seconds = 0.0  # As after a commit whose answer was lost.
    record(1, {1: 1.0}, seconds=2.0)
    assert count(Generation) == count(Elite) == 1
    assert (row().seconds, attempt.seconds) == (2.0, 2.0)


def test_a_commit_holds_when_publishing_fails(services, run_id, report, row, monkeypatch):
    def away(*_):
        raise OperationalError("", {}, Exception("away"))

    attempt = claim(services, run_id, "worker")
    monkeypatch.setattr(announce, "read_runs", away)
    attempt.record(report(1), 1.0)
    attempt.finish()
    assert row().status == "finished"
