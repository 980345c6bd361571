"""Runs survive the death of workers, of jobs and of Redis."""

from dataclasses import replace

import httpx
import pytest
from redis import ConnectionError
from sqlalchemy import select

from microcosmos_server.attempts.attempt import ClaimLost
from microcosmos_server.attempts.leases import end_job, fail_job
from microcosmos_server.core.database import ago, now
from microcosmos_server.deletion.purge import expire
from microcosmos_server.maintenance import reconcile as reconciler
from microcosmos_server.maintenance.reconcile import reconcile, take_turn
from microcosmos_server.queue.jobs import Jobs
from microcosmos_server.runs.lifecycle import MAX_ATTEMPTS
from microcosmos_server.services.messages import Events
from microcosmos_server.settings import MAX_DAYS, MAX_SECONDS, Settings
from microcosmos_server.tables import InstallationState, Run, Worker
from microcosmos_server.workers import registry

pytestmark = pytest.mark.postgresql


@pytest.fixture
def often(services):
    """Services whose reconciler takes a pass every 5 seconds."""
    settings = services.settings.model_copy(update={"reconcile_interval": 5.0})
    return replace(services, settings=settings)


@pytest.fixture(autouse=True)
def passes(services, update_rows):
    """Lets the last pass of the reconciler be as old as given; without one none was before."""

    def let_pass(seconds=None, since=None):
        with services.sessions.read() as session:
            last = None if seconds is None else ago(session, seconds)
            reachable = None if since is None else ago(session, since)
        values = {"reconciled_at": last, "seen_at": last, "reachable_since": reachable}
        update_rows(InstallationState, **values)

    let_pass()
    yield let_pass
    let_pass()


def test_a_server_reconciles_when_it_starts(
    run_id, attempt, serve, silence, row, eventually, passes
):
    silence()
    passes(5, since=100)
    with serve(reconcile_interval=0.05):
        eventually(lambda: row().status == "queued")


def test_the_longest_times_that_settings_take_break_no_pass(services, attempt, row):
    seconds = dict.fromkeys(("lease", "grace", "reconcile_interval"), float(MAX_SECONDS))
    days = {name: float(MAX_DAYS) for name in Settings.model_fields if name.startswith("keep_")}
    settings = services.settings.model_copy(update=seconds | days)
    longest = replace(services, settings=settings)
    assert take_turn(longest)
    assert not take_turn(longest)
    reconcile(longest)
    expire(longest)
    assert row().status == "running"


@pytest.mark.parametrize("action", [None, "cancel"])
def test_a_lease_does_not_expire_by_an_outage_of_the_database(
    services, often, api, run_id, attempt, row, silence, passes, update_rows, action
):
    """Workers could not report either; the first heartbeat may come after the first pass."""
    if action:
        api.post(f"runs/{run_id}/{action}")
        with services.sessions.read() as session:
            update_rows(Run, requested_at=ago(session, 60))
    silence()
    for seconds in (60, 5, 5, 5):  # The outage, and the first passes after it.
        with services.sessions.read() as session:
            since = session.scalar(select(InstallationState.reachable_since))
            last = ago(session, seconds)
        update_rows(InstallationState, reconciled_at=last, seen_at=last)
        assert take_turn(often)
        reconcile(services)
        assert (row().status, row().worker) == ("running", "worker")
    with services.sessions.read() as session:
        assert session.scalar(select(InstallationState.reachable_since)) == since, "it stays"
    passes(5, since=services.settings.lease + 1)
    reconcile(services)
    assert row().status == ("cancelled" if action else "queued"), "now it is the worker's fault"


def test_a_long_pass_is_no_outage(services, often, update_rows, passes):
    passes(5, since=1000)
    with services.sessions.read() as session:
        update_rows(InstallationState, reconciled_at=ago(session, 600))
        before = session.scalar(select(InstallationState.reachable_since))
    assert take_turn(often)
    with services.sessions.read() as session:
        assert session.scalar(select(InstallationState.reachable_since)) == before


def test_servers_take_turns(services, update_rows):
    update_rows(InstallationState, reconciled_at=None)
    assert [take_turn(services) for _ in range(3)] == [True, False, False]
    interval = services.settings.reconcile_interval
    with services.sessions.read() as session:
        earlier = ago(session, interval)
    update_rows(InstallationState, reconciled_at=earlier)
    assert [take_turn(services) for _ in range(2)] == [True, False]


def test_a_clock_that_is_set_back_stops_nothing(
    services, often, attempt, row, alive, passes, update_rows
):
    """Times that were written before are ahead of it, here by an hour."""
    alive("worker", "busy")
    with services.sessions.read() as session:
        ahead, before = ago(session, -3600), ago(session, -3600 + 100)
    update_rows(Run, heartbeat_at=ahead, queued_at=ahead)
    update_rows(Worker, heartbeat_at=ahead)
    state = {"reconciled_at": ahead, "seen_at": ahead, "passed_at": ahead}
    update_rows(InstallationState, **state, reachable_since=before)
    assert take_turn(often)
    assert not take_turn(often), "an interval later"
    reconcile(services)
    assert row().status == "running", "its lease counts from now"
    with services.sessions.read() as session:
        moment = now(session)
        state = session.scalars(select(InstallationState)).one()
        assert max(state.reconciled_at, state.passed_at, state.reachable_since) <= moment
        assert session.get_one(Worker, "worker").heartbeat_at <= moment
    assert row().heartbeat_at <= moment
    assert row().queued_at <= moment, "later runs would go before it"


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


def test_a_run_can_be_submitted_while_redis_is_away(spec, served, taken):
    address = served(redis_url="redis://127.0.0.1:1/0")
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


def test_a_pass_is_complete_without_redis(
    services, serve, monkeypatch, eventually, update_rows
):
    """Redis has an alert of its own."""

    def away(*_, **__):
        raise ConnectionError("Connection refused")

    def passed():
        with services.sessions.read() as session:
            return session.scalar(select(InstallationState.passed_at))

    update_rows(InstallationState, passed_at=None)
    monkeypatch.setattr(Jobs, "clean", away)
    monkeypatch.setattr(Events, "forget", away)
    with serve(reconcile_interval=0.05):
        eventually(passed)


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
