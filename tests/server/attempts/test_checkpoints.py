"""Checkpoints: what an attempt keeps, and what the next one goes on from."""

import errno
import shutil

import pytest

from server.attempts.checkpoints import CheckpointUnavailable
from server.attempts.claim import claim
from server.storage.artifacts import Artifacts
from server.tables import Artifact, Creature, Elite, Generation

pytestmark = pytest.mark.postgresql


def unmount(folder):
    shutil.rmtree(folder)


def lose_the_newest(folder):
    next(folder.glob("00000002-*")).unlink()


def damage_all(folder):
    for file in folder.iterdir():
        file.write_bytes(b"rot")


def test_generations_after_the_checkpoint_are_repeated(
    services, run_id, report, row, attempt, record, count
):
    for generation in range(1, 6):
        record(generation, {generation: 1.0})
        if generation == 3:
            attempt.save(3, b"state after 3")
    again = claim(services, run_id, "worker")
    assert (again.generation, again.seconds) == (3, 3.0)
    assert again.restore() == b"state after 3"
    assert (row().generation, row().evaluations, row().qd_score) == (3, 48, 30.0)
    assert count(Generation) == count(Elite) == 3
    assert count(Creature) == 5, "creatures are kept, for lineages"
    again.record(report(4, {4: 1.0}), 1.0)


def test_a_run_without_checkpoint_restarts(services, run_id, row, attempt, record):
    record(1, {1: 1.0})
    with pytest.raises(ValueError, match="at most 1; got 2"):
        attempt.save(2, b"data")
    again = claim(services, run_id, "worker")
    assert (again.generation, again.restore()) == (0, None)
    assert (row().generation, row().qd_score, row().seconds) == (0, None, 0)


def test_superfluous_checkpoints_are_deleted_with_their_files(
    services, run_id, attempt, record
):
    for generation in range(1, 13):
        record(generation)
        attempt.save(generation, f"state {generation}".encode())
    folder = services.settings.data / "artifacts" / "runs" / str(run_id)
    kept = sorted(int(file.name[:8]) for file in folder.iterdir())
    assert kept == [10, 11, 12]
    assert claim(services, run_id, "worker").restore() == b"state 12"


def test_a_full_disk_leaves_the_previous_checkpoint_and_a_warning(
    row, monkeypatch, attempt, record
):
    record(1)
    attempt.save(1, b"state 1")
    record(2)

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


def test_a_new_checkpoint_or_a_requeue_resets_the_attempts(services, run_id, report, row):
    for generation in range(1, 5):
        attempt = claim(services, run_id, "worker")
        attempt.record(report(generation), 1.0)
        attempt.save(generation, f"{generation}".encode())
        attempt.fail("error")
    for _ in range(5):
        claim(services, run_id, "worker").requeue()
    assert row().status == "queued"


def test_a_checkpoint_without_progress_resets_no_attempts(services, run_id, report, row):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    attempt.save(1, b"state")
    attempt.fail("error")
    for _ in range(3):
        attempt = claim(services, run_id, "worker")
        attempt.save(1, b"state")
        attempt.fail("error")
    assert row().status == "failed"


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


def test_a_run_goes_on_from_the_newest_checkpoint_that_is_sound(
    services, run_id, report, row, attempt, record, count
):
    for generation in range(1, 4):
        record(generation, {generation: 1.0})
        attempt.save(generation, f"state {generation}".encode())
    folder = services.settings.data / "artifacts" / "runs" / str(run_id)
    next(folder.glob("00000003-*")).write_bytes(b"rot")
    second = claim(services, run_id, "worker")
    assert second.restore() == b"state 2"
    assert (second.generation, second.seconds) == (2, 2.0)
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert count(Generation) == count(Elite) == 2
    assert "generation 3 is damaged" in row().warning
    assert "resumes from generation 2" in row().warning
    second.record(report(3, {3: 1.0}), 1.0)
    second.save(3, b"state 3")
    assert row().warning is None
    assert claim(services, run_id, "worker").restore() == b"state 3"


@pytest.mark.parametrize("harm", [unmount, lose_the_newest, damage_all])
def test_a_checkpoint_that_cannot_be_read_deletes_nothing(
    services, run_id, row, harm, attempt, record, count
):
    for generation in range(1, 3):
        record(generation, {generation: 1.0})
        attempt.save(generation, f"state {generation}".encode())
    harm(services.settings.data / "artifacts" / "runs" / str(run_id))
    second = claim(services, run_id, "worker")
    with pytest.raises(CheckpointUnavailable, match="checkpoint of generation 2"):
        second.restore()
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert count(Generation) == count(Elite) == count(Artifact) == 2


def test_a_run_resumes_when_its_files_are_there_again(
    services, run_id, attempt, record, tmp_path
):
    record(1, {1: 1.0})
    attempt.save(1, b"state 1")
    folder = services.settings.data / "artifacts"
    folder.rename(tmp_path / "elsewhere")
    with pytest.raises(CheckpointUnavailable):
        claim(services, run_id, "worker").restore()
    (tmp_path / "elsewhere").rename(folder)
    assert claim(services, run_id, "worker").restore() == b"state 1"
