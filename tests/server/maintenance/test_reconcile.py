"""Runs survive the death of workers, of jobs and of Redis."""

import httpx
import pytest
from redis import ConnectionError

from server.attempts.attempt import ClaimLost
from server.attempts.leases import end_job, fail_job
from server.core.database import ago
from server.maintenance import reconcile as reconciler
from server.maintenance.reconcile import reconcile, take_turn
from server.runs.lifecycle import MAX_ATTEMPTS
from server.tables import InstallationState, Run, Worker
from server.workers import registry

pytestmark = pytest.mark.postgresql


def test_a_server_reconciles_when_it_starts(run_id, attempt, serve, silence, row, eventually):
    silence()
    with serve(reconcile_interval=0.05):
        eventually(lambda: row().status == "queued")


def test_servers_take_turns(services, update_rows):
    update_rows(InstallationState, reconciled_at=None)
    assert [take_turn(services) for _ in range(3)] == [True, False, False]
    interval = services.settings.reconcile_interval
    with services.sessions.read() as session:
        earlier = ago(session, interval)
    update_rows(InstallationState, reconciled_at=earlier)
    assert [take_turn(services) for _ in range(2)] == [True, False]


def test_a_silent_workers_run_is_queued_again(services, attempt, flush, row, record, silence):
    flush()
    reconcile(services)
    assert row().status == "running"
    silence()
    reconcile(services)
    assert (row().status, row().worker, row().avoided_worker) == ("queued", None, "worker")
    with pytest.raises(ClaimLost):
        record(1)


def test_three_silent_workers_end_a_run(services, claim_run, row, silence):
    for _ in range(3):
        claim_run()
        silence()
        reconcile(services)
    assert row().status == "failed"
    assert "worker worker has not reported for 20 s" in row().error


@pytest.mark.parametrize(("action", "status"), [("pause", "paused"), ("cancel", "cancelled")])
def test_a_requested_state_is_applied_for_a_dead_worker(
    services, api, run_id, attempt, row, action, status, silence
):
    api.post(f"runs/{run_id}/{action}")
    silence()
    reconcile(services)
    assert (row().status, row().requested_state) == (status, None)
    assert (row().finished_at is None) == (status == "paused")


def test_a_worker_that_ignores_a_cancellation_loses_the_run(
    services, api, run_id, row, attempt, update_rows
):
    api.post(f"runs/{run_id}/cancel")
    reconcile(services)
    assert row().status == "running"
    update_rows(Run, requested_at=row().created_at.replace(year=2000))
    reconcile(services)
    assert row().status == "cancelled"
    with pytest.raises(ClaimLost):
        attempt.read_request()


def test_a_dead_jobs_run_is_queued_at_once(services, run_id, attempt, row):
    fail_job(services, run_id, "another", "killed")
    assert row().status == "running"
    fail_job(services, run_id, "worker", "killed by signal 9")
    assert (row().status, row().error) == ("queued", "killed by signal 9")


def test_deaths_before_the_claim_are_counted_and_end_the_run(services, run_id, row, taken):
    for number in range(1, MAX_ATTEMPTS):
        assert taken() == str(run_id)
        fail_job(services, run_id, "worker", "its process ended with status 1")
        assert (row().status, row().attempts_without_checkpoint) == ("queued", number)
    assert taken() == str(run_id)
    fail_job(services, run_id, "worker", "the last reason")
    assert row().status == "failed"
    assert row().error == "3 attempts without a new checkpoint; the last one: the last reason"


def test_the_death_of_a_job_whose_claim_was_lost_is_not_counted_twice(
    services, run_id, row, claim_run, silence
):
    claim_run()
    silence()
    reconcile(services)
    assert row().attempts_without_checkpoint == 1
    fail_job(services, run_id, "worker", "its heartbeats killed it")
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 1)


def test_a_job_killed_by_a_stopping_worker_costs_no_attempt(services, run_id, row, claim_run):
    for _ in range(4):
        attempt = claim_run()
        end_job(services, run_id, "another")
        assert row().status == "running"
        end_job(services, run_id, "worker")
        assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)
        with pytest.raises(ClaimLost):
            attempt.read_request()


def test_a_run_can_be_submitted_while_redis_is_away(spec, serve, taken):
    with serve(redis_url="redis://127.0.0.1:1/0") as address:
        body = {**spec, "seed": 7}
        answer = httpx.post(f"{address}/api/v1/runs", json=body, timeout=30)
        assert httpx.get(f"{address}/readyz", timeout=30).status_code == 503
    assert answer.status_code == 202
    run_id = answer.json()["id"]
    assert taken() == run_id


def test_an_outage_of_redis_does_not_end_the_reconciler(serve, monkeypatch, eventually):
    calls = []

    def sometimes(given):
        calls.append(given)
        if len(calls) < 3:
            raise ConnectionError("Connection refused")

    monkeypatch.setattr(reconciler, "reconcile", sometimes)
    with serve(reconcile_interval=0.01):
        eventually(lambda: len(calls) >= 5)


def test_workers_silent_for_long_are_removed(services, api, update_rows):
    registry.report(services.sessions, "worker", "cpu", 1, "idle")
    assert [worker["name"] for worker in api.get("workers").json()] == ["worker"]
    with services.sessions.read() as session:
        then = session.get_one(Worker, "worker").heartbeat_at.replace(year=2000)
    update_rows(Worker, heartbeat_at=then)
    assert api.get("workers").json() == []
    reconcile(services)
    with services.sessions.read() as session:
        assert session.get(Worker, "worker") is None
