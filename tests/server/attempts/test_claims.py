"""The fence: what one attempt writes, no other attempt can."""

import errno
from concurrent.futures import ThreadPoolExecutor

import pytest
from sqlalchemy import func, select, update
from sqlalchemy.exc import OperationalError

from server.attempts import leases
from server.attempts.begin import claim
from server.attempts.claim import CheckpointUnavailable, Claim, Fenced
from server.core.database import ago
from server.runs import lifecycle
from server.storage.artifacts import Artifacts
from server.tables import Artifact, Creature, Elite, Generation, Run

pytestmark = pytest.mark.postgresql


def count(services, table):
    with services.sessions.read() as session:
        return session.scalar(select(func.count()).select_from(table))


def silence(services, run_id):
    """The last heartbeat was a lease ago, and a little more, as if the worker were frozen."""
    with services.sessions.write.begin() as session:
        then = ago(session, services.settings.lease + 0.1)
        session.execute(update(Run).values(heartbeat_at=then).where(Run.id == run_id))


def test_only_one_worker_gets_a_run(services, run_id):
    assert claim(services, run_id, "first").attempt == 1
    assert claim(services, run_id, "second") is None


def test_of_many_that_claim_at_once_one_gets_it(services, run_id):
    with ThreadPoolExecutor(8) as pool:
        names = [f"worker {number}" for number in range(8)]
        claims = list(pool.map(lambda name: claim(services, run_id, name), names))
    assert len([found for found in claims if found]) == 1


def test_a_silent_workers_run_is_taken_and_the_woken_one_is_fenced(services, run_id, report):
    first = claim(services, run_id, "first")
    first.record(report(1, {0: 1.0}), 1.0)
    silence(services, run_id)
    second = claim(services, run_id, "second")
    assert second.attempt == 2
    writes = (
        lambda: first.record(report(2), 1.0),
        lambda: first.save(1, b"data"),
        lambda: first.warn("text"),
        first.requested,
        first.finish,
        first.pause,
        first.requeue,
        lambda: first.fail("error"),
    )
    for write in writes:
        with pytest.raises(Fenced):
            write()
    assert second.record(report(1, {0: 1.0}), 1.0) is None
    assert count(services, Generation) == 1


def test_what_was_recorded_beyond_the_checkpoint_is_done_again(services, run_id, report, row):
    first = claim(services, run_id, "worker")
    for generation in range(1, 6):
        first.record(report(generation, {generation: 1.0}), 1.0)
        if generation == 3:
            first.save(3, b"state after 3")
    again = claim(services, run_id, "worker")
    assert (again.generation, again.seconds) == (3, 3.0)
    assert again.restore() == b"state after 3"
    assert (row().generation, row().evaluations, row().qd_score) == (3, 48, 30.0)
    assert count(services, Generation) == count(services, Elite) == 3
    assert count(services, Creature) == 5, "creatures are kept, for lineages"
    again.record(report(4, {4: 1.0}), 1.0)


def test_without_a_checkpoint_a_run_begins_anew(services, run_id, report, row):
    claim(services, run_id, "worker").record(report(1, {1: 1.0}), 1.0)
    again = claim(services, run_id, "worker")
    assert (again.generation, again.restore()) == (0, None)
    assert (row().generation, row().qd_score, row().seconds) == (0, None, 0)


def test_a_generation_is_recorded_once_or_not_at_all(services, run_id, report):
    attempt = claim(services, run_id, "worker")
    broken = report(1, {1: 1.0})
    broken.elites[0].creature = "00" * 32  # Of which there is no creature.
    broken.elites[0].identity = None
    with pytest.raises(Exception, match=r"(?i)null"):
        attempt.record(broken, 1.0)
    assert count(services, Generation) == count(services, Elite) == 0
    assert attempt.seconds == 0
    attempt.record(report(1, {1: 1.0}), 1.0)


def test_numbers_that_are_not_finite_are_recorded_as_none(services, run_id, report, row):
    nothing = report(1)
    nothing.best = float("-inf")
    nothing.mean = float("nan")
    claim(services, run_id, "worker").record(nothing, 1.0)
    assert row().best is None


def test_a_checkpoint_must_be_of_a_recorded_generation(services, run_id, report):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    with pytest.raises(ValueError, match="at most 1; got 2"):
        attempt.save(2, b"data")


def test_superfluous_checkpoints_are_deleted_with_their_files(services, run_id, report):
    attempt = claim(services, run_id, "worker")
    for generation in range(1, 13):
        attempt.record(report(generation), 1.0)
        attempt.save(generation, f"state {generation}".encode())
    folder = services.settings.data / "artifacts" / "runs" / str(run_id)
    kept = sorted(int(file.name[:8]) for file in folder.iterdir())
    assert kept == [10, 11, 12]
    assert claim(services, run_id, "worker").restore() == b"state 12"


def test_a_full_disk_leaves_the_previous_checkpoint_and_a_warning(
    services, run_id, report, row, monkeypatch
):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    attempt.save(1, b"state 1")
    attempt.record(report(2), 1.0)

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Artifacts, "_rename", full)
        with pytest.raises(OSError, match="No space") as caught:
            attempt.save(2, b"state 2")
    attempt.warn(f"checkpoint failed: {caught.value.strerror}")
    assert row().warning == "checkpoint failed: No space left on device"
    assert attempt.restore() == b"state 1"
    attempt.save(2, b"state 2")
    assert row().warning is None
    assert attempt.restore() == b"state 2"


def test_three_attempts_without_a_checkpoint_end_a_run(services, run_id, row):
    for _ in range(2):
        claim(services, run_id, "worker").fail("Traceback: first")
        assert (row().status, row().finished_at) == ("queued", None)
    claim(services, run_id, "worker").fail("Traceback: last")
    assert row().status == "failed"
    assert row().finished_at is not None
    assert row().error == "3 attempts without a new checkpoint; the last one: Traceback: last"
    assert claim(services, run_id, "worker") is None


def test_a_new_checkpoint_or_an_orderly_end_gives_new_chances(services, run_id, report, row):
    for generation in range(1, 5):
        attempt = claim(services, run_id, "worker")
        attempt.record(report(generation), 1.0)
        attempt.save(generation, f"{generation}".encode())
        attempt.fail("error")
    for _ in range(5):
        claim(services, run_id, "worker").requeue()
    assert row().status == "queued"


def test_a_checkpoint_without_progress_gives_none(services, run_id, report, row):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    attempt.save(1, b"state")
    attempt.fail("error")
    for _ in range(3):
        attempt = claim(services, run_id, "worker")
        attempt.save(1, b"state")
        attempt.fail("error")
    assert row().status == "failed"


def test_a_finished_run_forgets_earlier_errors(services, run_id, row):
    claim(services, run_id, "worker").fail("error")
    claim(services, run_id, "worker").finish()
    assert (row().status, row().error) == ("finished", None)


def test_a_lease_is_renewed_by_whoever_holds_it(services, run_id, row):
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


def test_whoever_resumes_a_run_that_needs_leave_for_another_device_gives_it(services, run_id):
    first = claim(services, run_id, "first")
    assert not first.other_device
    first.wait_for_override("it began elsewhere")
    with services.sessions.write.begin() as session:
        run = session.get_one(Run, run_id)
        assert (run.status, run.warning) == ("paused", "it began elsewhere")
        lifecycle.resume(session, run)
    assert claim(services, run_id, "second").other_device


def test_resuming_a_run_that_needs_no_leave_gives_none(services, run_id):
    claim(services, run_id, "first").pause()
    with services.sessions.write.begin() as session:
        lifecycle.resume(session, session.get_one(Run, run_id))
    assert not claim(services, run_id, "second").other_device


@pytest.mark.parametrize("end", [Claim.pause, lambda held: held.wait_for_override("why")])
def test_a_cancellation_that_comes_while_a_pause_is_carried_out_holds(
    services, run_id, row, end
):
    attempt = claim(services, run_id, "worker")
    with services.sessions.write.begin() as session:
        lifecycle.cancel(session, session.get_one(Run, run_id))
    end(attempt)
    assert (row().status, row().requested_state) == ("cancelled", None)
    assert row().finished_at is not None


def test_a_generation_that_was_committed_unnoticed_is_not_written_again(
    services, run_id, report, row
):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, {1: 1.0}), 2.0)
    attempt.seconds = 0.0  # As after a commit whose answer was lost.
    attempt.record(report(1, {1: 1.0}), 2.0)
    assert count(services, Generation) == count(services, Elite) == 1
    assert (row().seconds, attempt.seconds) == (2.0, 2.0)


def test_what_was_committed_stands_where_nobody_can_be_told(
    services, run_id, report, row, monkeypatch
):
    def away(*_):
        raise OperationalError("", {}, Exception("away"))

    attempt = claim(services, run_id, "worker")
    monkeypatch.setattr(lifecycle, "read_runs", away)
    attempt.record(report(1), 1.0)
    attempt.finish()
    assert row().status == "finished"


def test_an_old_file_that_cannot_be_deleted_does_not_undo_a_checkpoint(
    services, run_id, report, row, monkeypatch
):
    def refuse(*_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Artifacts, "delete", refuse)
    attempt = claim(services, run_id, "worker")
    for generation in range(1, 6):
        attempt.record(report(generation), 1.0)
        attempt.save(generation, f"state {generation}".encode())
    assert row().checkpoint_generation == attempt.generation == 5


def test_a_run_goes_on_from_the_newest_checkpoint_that_is_sound(services, run_id, report, row):
    first = claim(services, run_id, "worker")
    for generation in range(1, 4):
        first.record(report(generation, {generation: 1.0}), 1.0)
        first.save(generation, f"state {generation}".encode())
    folder = services.settings.data / "artifacts" / "runs" / str(run_id)
    next(folder.glob("00000003-*")).write_bytes(b"rot")
    second = claim(services, run_id, "worker")
    assert second.restore() == b"state 2"
    assert (second.generation, second.seconds) == (2, 2.0)
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert count(services, Generation) == count(services, Elite) == 2
    assert "generation 3 is damaged" in row().warning
    assert "resumes from generation 2" in row().warning
    second.record(report(3, {3: 1.0}), 1.0)
    second.save(3, b"state 3")
    assert row().warning is None
    assert claim(services, run_id, "worker").restore() == b"state 3"


def unmount(folder):
    folder.rename(folder.with_name("elsewhere"))


def lose_the_newest(folder):
    next(folder.glob("00000002-*")).unlink()


def damage_all(folder):
    for file in folder.iterdir():
        file.write_bytes(b"rot")


@pytest.mark.parametrize("harm", [unmount, lose_the_newest, damage_all])
def test_a_checkpoint_that_cannot_be_read_deletes_nothing(services, run_id, report, row, harm):
    first = claim(services, run_id, "worker")
    for generation in range(1, 3):
        first.record(report(generation, {generation: 1.0}), 1.0)
        first.save(generation, f"state {generation}".encode())
    harm(services.settings.data / "artifacts" / "runs" / str(run_id))
    second = claim(services, run_id, "worker")
    with pytest.raises(CheckpointUnavailable, match="checkpoint of generation 2"):
        second.restore()
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert (
        count(services, Generation) == count(services, Elite) == count(services, Artifact) == 2
    )


def test_a_run_resumes_when_its_files_are_there_again(services, run_id, report):
    first = claim(services, run_id, "worker")
    first.record(report(1, {1: 1.0}), 1.0)
    first.save(1, b"state 1")
    folder = services.settings.data / "artifacts"
    folder.rename(folder.with_name("elsewhere"))
    with pytest.raises(CheckpointUnavailable):
        claim(services, run_id, "worker").restore()
    folder.with_name("elsewhere").rename(folder)
    assert claim(services, run_id, "worker").restore() == b"state 1"
