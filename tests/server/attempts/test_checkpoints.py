"""Checkpoints: saved, pruned, and restored by the next attempt."""

import shutil
from contextlib import contextmanager

import pytest
from sqlalchemy.exc import OperationalError

from microcosmos_server.attempts.checkpoints import CheckpointUnavailable
from microcosmos_server.core import database
from microcosmos_server.storage.garbage import remove_files
from microcosmos_server.tables import Artifact, Creature, Elite, Generation

pytestmark = pytest.mark.postgresql


def unmount(folder):
    shutil.rmtree(folder)


def lose_the_newest(folder):
    next(folder.glob("00000002-*")).unlink()


def damage_all(folder):
    for file in folder.iterdir():
        file.write_bytes(b"rot")


@pytest.fixture
def folder(services, run_id):
    return services.settings.data / "artifacts" / "runs" / str(run_id)


@pytest.fixture
def save(attempt, record):
    """Records and saves some generations."""

    def save(*generations):
        for generation in generations:
            record(generation, {generation: 1.0})
            attempt.save(generation, f"state {generation}".encode())

    return save


def test_corrected_figures_are_those_of_the_last_reevaluation(claim_run, report, row, attempt):
    for generation, score in enumerate((None, 9.0, None, 8.0, None), 1):
        summary = {"corrected_qd_score": score, "corrected_coverage": 0.5, "hit_rate": 0.7}
        attempt.record(report(generation, summary=summary if score else {}), 1.0)
        if generation == 3:
            attempt.save(3, b"state after 3")
    assert (row().corrected_qd_score, row().hit_rate) == (8.0, 0.7)
    claim_run()
    assert (row().generation, row().corrected_qd_score) == (3, 9.0)


def test_generations_after_the_checkpoint_are_repeated(
    claim_run, report, row, attempt, record, count
):
    for generation in range(1, 6):
        record(generation, {generation: 1.0})
        if generation == 3:
            attempt.save(3, b"state after 3")
    again = claim_run()
    assert (again.generation, again.seconds) == (3, 3.0)
    assert again.restore() == b"state after 3"
    assert (row().generation, row().evaluations, row().qd_score) == (3, 48, 30.0)
    assert count(Generation) == count(Elite) == 3
    assert count(Creature) == 5, "creatures are kept, for lineages"
    again.record(report(4, {4: 1.0}), 1.0)


def test_a_run_without_checkpoint_restarts(claim_run, row, attempt, record):
    record(1, {1: 1.0})
    with pytest.raises(ValueError, match="at most 1; got 2"):
        attempt.save(2, b"data")
    again = claim_run()
    assert (again.generation, again.restore()) == (0, None)
    assert (row().generation, row().qd_score, row().seconds) == (0, None, 0)


def test_superfluous_checkpoints_are_deleted_with_their_files(
    claim_run, services, folder, save
):
    save(*range(1, 13))
    assert remove_files(services.sessions, services.artifacts)
    assert sorted(int(file.name[:8]) for file in folder.iterdir()) == [10, 11, 12]
    assert claim_run().restore() == b"state 12"


def test_a_new_checkpoint_or_a_requeue_resets_the_attempts(claim_run, report, row):
    for generation in range(1, 5):
        attempt = claim_run()
        attempt.record(report(generation), 1.0)
        attempt.save(generation, f"{generation}".encode())
        attempt.fail("error")
    for _ in range(5):
        claim_run().requeue()
    assert row().status == "queued"


def test_a_checkpoint_without_progress_resets_no_attempts(claim_run, row, save, attempt):
    save(1)
    attempt.fail("error")
    for _ in range(3):
        attempt = claim_run()
        attempt.save(1, b"state")
        attempt.fail("error")
    assert row().status == "failed"


def test_a_run_goes_on_from_the_newest_intact_checkpoint(
    claim_run, folder, report, row, save, count
):
    save(1, 2, 3)
    next(folder.glob("00000003-*")).write_bytes(b"rot")
    second = claim_run()
    assert second.restore() == b"state 2"
    assert (second.generation, second.seconds) == (2, 2.0)
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert count(Generation) == count(Elite) == 2
    assert "generation 3 is damaged" in row().warning
    assert "resumes from generation 2" in row().warning
    second.record(report(3, {3: 1.0}), 1.0)
    second.save(3, b"state 3")
    assert row().warning is None
    assert claim_run().restore() == b"state 3"


def test_a_run_goes_on_from_an_intact_checkpoint_if_the_answer_to_its_choice_was_lost(
    claim_run, folder, row, save, monkeypatch
):
    save(1, 2, 3)
    next(folder.glob("00000003-*")).write_bytes(b"rot")
    second = claim_run()
    second.outage_seconds = 60.0
    monkeypatch.setattr(database, "RETRY_SECONDS", 0.0)
    current, answers = second.current, [OperationalError("", {}, Exception("away"))]

    @contextmanager
    def losing(**columns):
        with current(**columns) as held:
            yield held
        if answers:
            raise answers.pop()

    monkeypatch.setattr(second, "current", losing)
    assert second.restore() == b"state 2"
    assert (second.generation, second.seconds) == (2, 2.0)
    assert second.work == (row().evaluations, row().infeasible)


@pytest.mark.parametrize("harm", [unmount, lose_the_newest, damage_all])
def test_a_checkpoint_that_cannot_be_read_deletes_nothing(
    claim_run, folder, row, harm, save, count
):
    save(1, 2)
    harm(folder)
    second = claim_run()
    with pytest.raises(CheckpointUnavailable, match="checkpoint of generation 2"):
        second.restore()
    assert (row().generation, row().checkpoint_generation, row().qd_score) == (2, 2, 20.0)
    assert count(Generation) == count(Elite) == count(Artifact) == 2
