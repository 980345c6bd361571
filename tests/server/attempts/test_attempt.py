"""Attempts: recording, checkpoints, stopping and failing."""

import errno
import shutil
import time
from dataclasses import replace
from threading import Timer

import pytest
import reports
from fsspec.implementations.local import LocalFileSystem
from sqlalchemy import select, text
from sqlalchemy.exc import OperationalError

from microcosmos_server.attempts import attempt as attempts
from microcosmos_server.attempts.claim import NothingComputed, claimed
from microcosmos_server.core import database
from microcosmos_server.runs import lifecycle
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.tables import Run


class Disk(LocalFileSystem):
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
    """The services of the tests, with files on a disk that can be full."""
    artifacts = Artifacts(services.settings.artifacts)
    artifacts.files = disk
    settings = services.settings.model_copy(update={"checkpoint_interval": 0.0})
    return replace(services, artifacts=artifacts, settings=settings)


@pytest.fixture
def held(services, run_id):
    """Holds a claim on the queued run, as a worker does."""
    return lambda worker="worker": claimed(services, run_id, worker, lambda: False)


def write(attempt, generation, save):
    """Record and checkpoint as a worker does."""
    attempt.record(reports.report(generation), 1.0)
    if attempt.checkpoint_due():
        attempt.checkpoint(generation, save())


def test_a_full_disk_keeps_the_last_checkpoint_until_there_is_room(held, row, disk):
    with held() as attempt:
        write(attempt, 1, lambda: b"first")
        disk.full = True
        write(attempt, 2, lambda: b"second")
        assert "No space left on device" in row().warning
        assert row().checkpoint_generation == 1
        assert attempt.restore() == b"first"
        disk.full = False
        write(attempt, 3, lambda: b"third")
    assert row().warning is None
    assert row().checkpoint_generation == 3
    assert attempt.restore() == b"third"


def test_a_run_whose_end_cannot_be_saved_pauses_with_the_reason(held, row, disk):
    with held() as attempt:
        disk.full = True
        write(attempt, 1, lambda: b"data")
        attempt.end(done=True, generation=1, save=lambda: b"data")
    assert row().status == "paused"
    assert "No space left on device" in row().warning


def test_a_run_that_is_done_is_saved_before_it_is_finished(held, row):
    with held() as attempt:
        write(attempt, 1, lambda: b"data")
        attempt.end(done=True, generation=1, save=lambda: pytest.fail("it was saved already"))
    assert row().status == "finished"
    assert attempt.restore() == b"data"


@pytest.mark.parametrize(
    ("action", "status"), [(lifecycle.pause, "paused"), (lifecycle.cancel, "cancelled")]
)
def test_a_requested_state_is_carried_out_between_blocks(
    services, run_id, held, row, monkeypatch, action, status
):
    monkeypatch.setattr(attempts, "CHECK_SECONDS", 0)
    with held() as attempt:
        write(attempt, 1, lambda: b"1")
        assert not attempt.interrupted()
        with services.sessions.write.begin() as session:
            action(session, session.get_one(Run, run_id))
        assert attempt.interrupted()
        attempt.end(done=False, generation=1, save=lambda: b"1")
    assert row().status == status
    assert row().checkpoint_generation == 1


@pytest.mark.parametrize("late", [False, True])
def test_a_cancellation_that_is_taken_back_costs_no_attempt(
    services, run_id, held, row, monkeypatch, late
):
    monkeypatch.setattr(attempts, "CHECK_SECONDS", 0)

    def act(action):
        with services.sessions.write.begin() as session:
            action(session, session.get_one(Run, run_id))

    with held() as attempt:
        write(attempt, 1, lambda: b"1")
        act(lifecycle.cancel)
        if late:  # The worker has seen it, and stops already.
            assert attempt.interrupted()
        act(lifecycle.uncancel)
        if not late:
            assert not attempt.interrupted()
            return
        attempt.end(done=False, generation=1, save=lambda: b"1")
    assert (row().status, row().interrupted, row().attempts_without_checkpoint) == (
        "queued",
        True,
        0,
    )


def test_a_cancellation_that_is_taken_back_in_the_last_moment_is_none(
    services, run_id, held, row
):
    with held() as attempt:
        write(attempt, 1, lambda: b"1")
        attempt.cancel()  # It was asked to, and has looked before the undo.
    assert (row().status, row().worker, row().interrupted) == ("queued", None, True)
    assert row().finished_at is None


def test_a_stopping_worker_requeues_the_run_at_no_cost(held, row):
    with held() as attempt:
        write(attempt, 1, lambda: b"1")
        attempt.stop_requested = lambda: True
        assert attempt.interrupted()
        attempt.end(done=False, generation=1, save=lambda: b"1")
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


def test_the_third_failure_without_a_checkpoint_is_final(held, row, report):
    for status in ("queued", "queued", "failed"):
        with held() as attempt:
            attempt.record(report(1), 1.0)
            raise ArithmeticError("the engine broke")
        assert row().status == status
    assert row().error.endswith("; the last one: ArithmeticError: the engine broke")
    assert row().error_details.startswith("Traceback")


def test_an_error_before_the_first_generation_is_left_to_the_supervisor(held, row):
    with pytest.raises(NothingComputed) as caught, held():
        raise ArithmeticError("there is no GPU")
    assert isinstance(caught.value.__cause__, ArithmeticError)
    assert (row().status, row().error) == ("running", None)


def test_a_worker_that_lost_its_run_ends_silently(held, row, update_rows):
    with held("first") as attempt:
        update_rows(Run, heartbeat_at=None)
        with held("second"):
            write(attempt, 1, lambda: b"1")
            pytest.fail("the write succeeded")
    assert (row().worker, row().attempt, row().generation) == ("second", 2, 0)


def test_a_run_without_its_files_pauses_with_the_reason(services, held, row):
    with held() as attempt:
        write(attempt, 1, lambda: b"state")
    shutil.rmtree(services.settings.data / "artifacts" / "runs")
    with held() as attempt:
        attempt.restore()
        pytest.fail("the checkpoint was restored")
    assert (row().status, row().generation, row().checkpoint_generation) == ("paused", 1, 1)
    assert "Check MICROCOSMOS_ARTIFACTS_URL" in row().warning


@pytest.fixture
def mount(services):
    """The folder of the store, whose mount is lost and comes back."""
    return Mount(services.settings.data / "artifacts")


class Mount:
    def __init__(self, folder):
        self.folder, self.away = folder, folder.with_name("away")

    def lose(self, empty):
        self.folder.rename(self.away)
        self.folder.mkdir() if empty else self.folder.write_text("no folder")

    def restore(self):
        shutil.rmtree(self.folder) if self.folder.is_dir() else self.folder.unlink()
        self.away.rename(self.folder)


@pytest.mark.parametrize("empty", [True, False])
def test_a_run_whose_store_is_away_waits_in_the_queue(held, row, mount, empty):
    with held() as attempt:
        write(attempt, 1, lambda: b"state")
    mount.lose(empty)
    with held() as attempt:
        attempt.outage_seconds = 0.0
        attempt.restore()
        pytest.fail("the checkpoint was restored")
    mount.restore()
    assert (row().status, row().generation, row().warning) == ("queued", 1, None)
    with held() as attempt:
        assert attempt.restore() == b"state"


@pytest.mark.parametrize("empty", [True, False])
def test_a_run_that_is_done_waits_for_its_store(held, row, mount, empty):
    with held() as attempt:
        write(attempt, 1, lambda: b"state")
        attempt.record(reports.report(2), 1.0)
        mount.lose(empty)
        assert not attempt.checkpoint(2, b"the end")
        assert row().warning.startswith("The checkpoint of generation 2 could not be written")
        Timer(0.5, mount.restore).start()
        attempt.end(done=True, generation=2, save=lambda: b"the end")
        assert attempt.restore() == b"the end"
    assert (row().status, row().warning) == ("finished", None)
    assert not any(mount.folder.rglob("*.part"))


def test_a_run_whose_end_waits_in_vain_for_its_store_is_queued(held, row, mount):
    with held() as attempt:
        write(attempt, 1, lambda: b"state")
        attempt.record(reports.report(2), 1.0)
        mount.lose(empty=True)
        attempt.outage_seconds = 0.0
        attempt.end(done=True, generation=2, save=lambda: b"the end")
    mount.restore()
    assert (row().status, row().checkpoint_generation) == ("queued", 1)
    assert "has no file `installation`" in row().warning
    with held() as attempt:
        assert attempt.restore() == b"state"


@pytest.fixture
def database_fails(monkeypatch):
    """A function that makes the database fail a number of times."""
    monkeypatch.setattr(database, "RETRY_SECONDS", 0)

    def fail(tries):
        answers = [OperationalError("", {}, Exception("away"))] * tries

        def change(*args, **values):
            if answers:
                raise answers.pop()
            return lifecycle.change(*args, **values)

        monkeypatch.setattr(attempts, "change", change)

    return fail


def test_a_generation_waits_for_a_database_that_is_away(held, row, report, database_fails):
    with held() as attempt:
        database_fails(2)
        attempt.record(report(1), 1.0)
    assert row().generation == 1


@pytest.mark.postgresql
@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_generation_waits_for_a_database_that_is_read_only(
    attempt, record, row, read_only, monkeypatch
):
    monkeypatch.setattr(database, "RETRY_SECONDS", 0)
    attempt.outage_seconds = 60.0
    read_only(2)
    record(1)
    assert row().generation == 1


@pytest.mark.postgresql
@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_transaction_that_the_database_has_ended_is_an_outage(attempt):
    def freeze():
        with attempt.current() as (session, _):
            session.execute(text("SET LOCAL idle_in_transaction_session_timeout = 10"))
            time.sleep(0.2)
            session.execute(select(Run))

    with pytest.raises(OperationalError):
        freeze()
    attempt.read_request()  # Over another connection.


def test_a_stopping_worker_does_not_wait_for_the_database(attempt, record, database_fails):
    attempt.outage_seconds, attempt.stop_requested = 60.0, lambda: True
    database_fails(1)
    with pytest.raises(OperationalError):
        record(1)


def test_the_first_generation_is_saved_at_once_and_the_next_after_the_interval(
    services, run_id, row
):
    settings = services.settings.model_copy(update={"checkpoint_interval": 3600.0})
    patient = replace(services, settings=settings)
    with claimed(patient, run_id, "worker", lambda: False) as attempt:
        write(attempt, 1, lambda: b"first")
        assert row().checkpoint_generation == 1
        write(attempt, 2, lambda: pytest.fail("it was saved a moment ago"))
    assert attempt.restore() == b"first"
