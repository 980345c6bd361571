"""Totals: what happened on each host, in numbers that never fall."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from microcosmos_server.attempts.leases import end_job, fail_job
from microcosmos_server.core.database import ago
from microcosmos_server.deletion.purge import purge
from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.tables import Run, Total
from microcosmos_server.workers import totals

pytestmark = pytest.mark.postgresql


@pytest.fixture
def counted(services):
    """Reads the totals of a host, `worker` by default."""

    def read(host="worker"):
        with services.sessions.read() as session:
            return totals.read_by_host(session, {host})[host]

    return read


def test_attempts_and_their_failures_are_counted_by_host_and_reason(
    services, run_id, claim_run, counted, silence
):
    claim_run().fail("ValueError")
    claim_run()
    fail_job(services, run_id, "worker", "its process was killed")
    claim_run()
    end_job(services, run_id, "worker", broken=True)
    claim_run()
    end_job(services, run_id, "worker")
    claim_run()
    silence()
    reconcile(services)
    assert counted() == {totals.ATTEMPTS: 5} | dict.fromkeys(totals.FAILURES.values(), 1)


def test_a_checkpoint_that_cannot_be_written_is_counted(
    services, attempt, record, counted, monkeypatch
):
    def full(*_):
        raise OSError(28, "No space left on device")

    record(1, {1: 1.0})
    monkeypatch.setattr(services.artifacts, "write", full)
    for _ in range(2):
        assert not attempt.checkpoint(1, b"data")
    assert counted()[totals.CHECKPOINT_FAILURES] == 2


def test_work_stays_counted_when_it_is_rewound_or_deleted(
    services, run_id, claim_run, record, counted, update_rows
):
    record(4, {5: 1.0}, seconds=10.0)
    work = {key: counted()[key] for key in (totals.EVALUATIONS, totals.COMPUTING_SECONDS)}
    assert work == {totals.EVALUATIONS: 64, totals.COMPUTING_SECONDS: 10}
    end_job(services, run_id, "worker")
    again = claim_run()
    assert again.work == (0, 0), "nothing was saved"
    assert counted()[totals.EVALUATIONS] == 64
    again.finish()
    with services.sessions.read() as session:
        then = ago(session, 1)
    update_rows(Run, deleted_at=then, purge_at=then)
    purge(services)
    with services.sessions.read() as session:
        assert session.get(Run, run_id) is None
        assert totals.read(session)[totals.EVALUATIONS] == 64


def test_concurrent_counts_are_all_there(services, counted):
    def add(number):
        with services.sessions.write.begin() as session:
            totals.count(session, f"worker-{number}", totals.ATTEMPTS)
            totals.add(session, "worker", {totals.XID_ERRORS: 2, totals.EVALUATIONS: 1})

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(add, range(40)))
    expected = {totals.ATTEMPTS: 40, totals.XID_ERRORS: 80, totals.EVALUATIONS: 40}
    assert counted() == expected


def test_hosts_that_changed_long_ago_are_not_shown_and_stay_counted(
    services, update_rows, monkeypatch
):
    with services.sessions.write.begin() as session:
        for name in ("old-1", "new-1", "newest-1"):
            totals.count(session, name, totals.ATTEMPTS)
        then = ago(session, totals.HOST_SECONDS + 1)
    update_rows(Total, Total.host == "old", changed_at=then)
    with services.sessions.read() as session:
        assert totals.read_by_host(session, set()).keys() == {"new", "newest"}
        assert totals.read(session)[totals.ATTEMPTS] == 3
        monkeypatch.setattr(totals, "MAX_HOSTS", 1)
        assert len(totals.read_by_host(session, set())) == 1
