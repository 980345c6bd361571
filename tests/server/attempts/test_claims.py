"""Claims and leases: only the current attempt writes to a run."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from redis import ConnectionError
from sqlalchemy import update
from sqlalchemy.exc import OperationalError

from microcosmos_server.attempts import leases
from microcosmos_server.attempts.attempt import Attempt, ClaimLost
from microcosmos_server.runs import announce, lifecycle
from microcosmos_server.tables import Elite, Generation, Run

pytestmark = pytest.mark.postgresql


def act(services, run_id, action):
    with services.sessions.write.begin() as session:
        action(session, session.get_one(Run, run_id))


def test_one_of_many_concurrent_claims_succeeds(claim_run):
    with ThreadPoolExecutor(8) as pool:
        claims = list(pool.map(claim_run, [f"worker {number}" for number in range(8)]))
    (held,) = (found for found in claims if found)
    assert held.number == 1
    assert claim_run("another") is None


@pytest.mark.parametrize("status", ["paused", "finished", "failed", "cancelled"])
def test_a_run_that_is_not_queued_is_not_claimed(services, run_id, claim_run, row, status):
    """Since its worker was told of it, somebody may have paused or cancelled it."""
    with services.sessions.write.begin() as session:
        session.execute(update(Run).where(Run.id == run_id).values(status=status))
    assert claim_run() is None
    assert (row().status, row().attempt, row().worker) == (status, 0, None)


def test_a_silent_workers_run_is_claimed_and_its_writes_refused(
    claim_run, report, count, silence
):
    first = claim_run("first")
    first.record(report(1, {0: 1.0}), 1.0)
    silence()
    second = claim_run("second")
    assert second.number == 2
    writes = (
        lambda: first.record(report(2), 1.0),
        lambda: first.save(1, b"data"),
        lambda: first.warn("text"),
        first.read_request,
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


def test_a_finished_run_forgets_errors_and_numbers_that_are_not_finite(claim_run, report, row):
    claim_run().fail("error")
    attempt = claim_run()
    nothing = report(1)
    nothing.best, nothing.mean = float("-inf"), float("nan")
    attempt.record(nothing, 1.0)
    assert row().best is None
    attempt.finish()
    assert (row().status, row().error) == ("finished", None)


def test_a_lease_is_renewed_by_its_holder(services, run_id, claim_run, row):
    def beat(worker):
        return leases.heartbeat(services.sessions, run_id, worker)

    assert beat("first") == "over"
    attempt = claim_run("first")
    before = row().heartbeat_at
    assert beat("first") == "held"
    assert row().heartbeat_at >= before
    assert beat("second") == "lost"
    attempt.finish()
    assert beat("first") == "over"


def test_redis_can_be_away_while_a_run_is_recorded(services, attempt, record, row, monkeypatch):
    def away(*_, **__):
        raise ConnectionError("Connection refused")

    monkeypatch.setattr(services.events.redis, "execute_command", away)
    record(1, {1: 1.0})
    attempt.finish()
    services.events.messenger.flush()
    assert row().status == "finished"


@pytest.mark.parametrize("end", [Attempt.pause, lambda held: held.pause_until_resumed("why")])
def test_a_cancellation_overrides_a_pause_under_way(services, run_id, row, end, attempt):
    act(services, run_id, lifecycle.cancel)
    end(attempt)
    assert (row().status, row().requested_state) == ("cancelled", None)
    assert row().finished_at is not None


def test_a_committed_generation_is_not_written_twice(row, attempt, record, count):
    record(1, {1: 1.0}, seconds=2.0)
    attempt.seconds = 0.0  # As after a commit whose answer was lost.
    record(1, {1: 1.0}, seconds=2.0)
    assert count(Generation) == count(Elite) == 1
    assert (row().seconds, attempt.seconds) == (2.0, 2.0)


def test_a_commit_holds_when_publishing_fails(attempt, record, row, monkeypatch):
    def away(*_):
        raise OperationalError("", {}, Exception("away"))

    monkeypatch.setattr(announce, "read_runs", away)
    record(1)
    attempt.finish()
    assert row().status == "finished"
