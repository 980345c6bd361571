"""Heartbeats, and what follows from a run that is lost."""

import pytest
from sqlalchemy import select, update

from server.attempts.claim import claim
from server.tables import CANCELLED, Run, Worker
from server.workers import registry
from worker.device import Device
from worker.pulse import PATIENCE, Pulse


@pytest.fixture
def pulse(services):
    return Pulse(services.sessions, "worker", Device("some device", 8 << 30, {}), lease=20)


@pytest.fixture
def killed():
    return []


def change(services, **values):
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(**values))


def test_a_worker_tells_its_device_its_memory_and_its_run(services, pulse, run_id, killed):
    claim(services, run_id, "worker")
    pulse.watch(run_id, lambda: killed.append(run_id))
    pulse.beat()
    with services.sessions.read() as session:
        found = registry.live(session, 20)[0]
    assert (found.name, found.device, found.memory_bytes) == ("worker", "some device", 8 << 30)
    assert (found.status, found.run_id) == ("busy", run_id)
    assert not killed


def test_a_beat_renews_the_lease(services, pulse, run_id, row, killed):
    claim(services, run_id, "worker")
    change(services, heartbeat_at=None)
    pulse.watch(run_id, lambda: killed.append(run_id))
    pulse.beat()
    assert row().heartbeat_at is not None


def test_the_job_of_a_run_that_another_took_is_killed_at_once(services, pulse, run_id, killed):
    claim(services, run_id, "worker")
    pulse.watch(run_id, lambda: killed.append(run_id))
    pulse.beat()
    change(services, worker="another")
    pulse.beat()
    assert killed == [run_id]


def test_a_job_that_does_not_end_with_its_run_is_killed_after_a_while(
    services, pulse, run_id, killed
):
    claim(services, run_id, "worker")
    pulse.watch(run_id, lambda: killed.append(run_id))
    pulse.beat()
    change(services, status=CANCELLED, worker=None)
    for _ in range(PATIENCE):
        pulse.beat()
    assert not killed
    pulse.beat()
    assert killed == [run_id]


def test_a_job_that_has_not_claimed_its_run_yet_is_left_alone(pulse, run_id, killed):
    pulse.watch(run_id, lambda: killed.append(run_id))
    for _ in range(PATIENCE + 2):
        pulse.beat()
    assert not killed


def test_a_worker_that_ended_is_off_the_list(services, pulse):
    pulse.start()
    pulse.end()
    with services.sessions.read() as session:
        assert not session.scalars(select(Worker)).all()
