"""Attempts: recording, checkpoints, stopping and failing."""

import errno
import shutil
from dataclasses import replace

import pytest
from fsspec.implementations.local import LocalFileSystem
from sqlalchemy import update
from sqlalchemy.exc import OperationalError

from server.attempts import attempt
from server.attempts.claim import claim, claimed
from server.core import database
from server.runs import lifecycle
from server.storage.artifacts import Artifacts
from server.tables import Run


class Disk(LocalFileSystem):
    """A disk that can be full."""

    cachable = False
    full = False

    def open(self, path, mode="rb", **options):
        if self.full and "w" in mode:
            raise OSError(errno.ENOSPC, "No space left on device", path)
        return super().open(path, mode, **options)


@pytest.fixture
def disk():
    return Disk()


@pytest.fixture
def services(services, disk):
    """The common ones, their files on a disk that can be full."""
    artifacts = Artifacts(services.settings.artifacts)
    artifacts.files = disk
    settings = services.settings.model_copy(update={"checkpoint_interval": 0.0})
    return replace(services, artifacts=artifacts, settings=settings)


def never():
    return False


def write(held, report, save):
    """Record and checkpoint as a worker does."""
    held.record(report, 1.0)
    if held.checkpoint_due():
        held.checkpoint(report.generation, save())


def wish(services, run_id, action):
    with services.sessions.write.begin() as session:
        action(session, session.get_one(Run, run_id))


def test_a_full_disk_keeps_the_last_checkpoint_until_there_is_room(
    services, run_id, row, report, disk
):
    with claimed(services, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"first")
        disk.full = True
        write(held, report(2), lambda: b"second")
        assert "No space left on device" in row().warning
        assert row().checkpoint_generation == 1
        assert held.restore() == b"first"
        disk.full = False
        write(held, report(3), lambda: b"third")
    assert row().warning is None
    assert row().checkpoint_generation == 3
    assert held.restore() == b"third"


def test_a_run_whose_end_cannot_be_saved_pauses_with_the_reason(
    services, run_id, row, report, disk
):
    with claimed(services, run_id, "worker", never) as held:
        disk.full = True
        write(held, report(1), lambda: b"data")
        held.end(done=True, generation=1, save=lambda: b"data")
    assert row().status == "paused"
    assert "No space left on device" in row().warning


def test_a_run_that_is_done_is_saved_before_it_is_finished(services, run_id, row, report):
    with claimed(services, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"data")
        held.end(done=True, generation=1, save=lambda: pytest.fail("it was saved already"))
    assert row().status == "finished"
    assert held.restore() == b"data"


@pytest.mark.parametrize(
    ("action", "status"), [(lifecycle.pause, "paused"), (lifecycle.cancel, "cancelled")]
)
def test_a_requested_state_is_carried_out_between_blocks(
    services, run_id, row, report, monkeypatch, action, status
):
    monkeypatch.setattr(attempt, "CHECK_SECONDS", 0)
    with claimed(services, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"1")
        assert not held.interrupted()
        wish(services, run_id, action)
        assert held.interrupted()
        held.end(done=False, generation=1, save=lambda: b"1")
    assert row().status == status
    assert row().checkpoint_generation == 1


def test_a_stopping_worker_requeues_the_run_at_no_cost(services, run_id, row, report):
    with claimed(services, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"1")
        held.stop_requested = lambda: True
        assert held.interrupted()
        held.end(done=False, generation=1, save=lambda: b"1")
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


def test_the_third_failure_without_a_checkpoint_is_final(services, run_id, row):
    for status in ("queued", "queued", "failed"):
        with claimed(services, run_id, "worker", never):
            raise ArithmeticError("the engine broke")
        assert row().status == status
    assert "ArithmeticError: the engine broke" in row().error


def test_a_worker_that_lost_its_run_ends_silently(services, run_id, row, report):
    with claimed(services, run_id, "first", never) as held:
        with services.sessions.write.begin() as session:
            session.execute(update(Run).values(heartbeat_at=None))
        with claimed(services, run_id, "second", never):
            write(held, report(1), lambda: b"1")
            pytest.fail("it was let through")
    assert (row().worker, row().attempt, row().generation) == ("second", 2, 0)


def test_a_run_without_its_files_pauses_with_the_reason(services, run_id, row, report):
    with claimed(services, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"state")
    shutil.rmtree(services.settings.data / "artifacts")
    with claimed(services, run_id, "worker", never) as held:
        held.restore()
        pytest.fail("it was let through")
    assert (row().status, row().generation, row().checkpoint_generation) == ("paused", 1, 1)
    assert "Check MICROCOSMOS_ARTIFACTS_URL" in row().warning


def test_a_running_run_cannot_be_claimed(services, run_id):
    with (
        claimed(services, run_id, "first", never),
        claimed(services, run_id, "second", never) as held,
    ):
        assert held is None


@pytest.fixture
def away(monkeypatch):
    """A database that is away for so many tries."""
    monkeypatch.setattr(database, "RETRY_SECONDS", 0)

    def leave(tries):
        answers = [OperationalError("", {}, Exception("away"))] * tries

        def change(*args, **values):
            if answers:
                raise answers.pop()
            return lifecycle.change(*args, **values)

        monkeypatch.setattr(attempt, "change", change)

    return leave


def test_a_generation_waits_for_a_database_that_is_away(services, run_id, row, report, away):
    with claimed(services, run_id, "worker", never) as held:
        away(2)
        held.record(report(1), 1.0)
    assert row().generation == 1


def test_a_stopping_worker_does_not_wait_for_the_database(services, run_id, report, away):
    held = claim(services, run_id, "worker")
    held.outage_seconds, held.stop_requested = 60.0, lambda: True
    away(1)
    with pytest.raises(OperationalError):
        held.record(report(1), 1.0)


def test_the_first_generation_is_saved_at_once_and_the_next_after_the_interval(
    services, run_id, row, report
):
    settings = services.settings.model_copy(update={"checkpoint_interval": 3600.0})
    patient = replace(services, settings=settings)
    with claimed(patient, run_id, "worker", never) as held:
        write(held, report(1), lambda: b"first")
        assert row().checkpoint_generation == 1
        write(held, report(2), lambda: pytest.fail("it was saved a moment ago"))
    assert held.restore() == b"first"
