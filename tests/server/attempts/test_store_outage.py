"""A store that does not answer costs no attempt: the run waits, or leaves its worker."""

from dataclasses import replace
from threading import Timer

import pytest
import reports
from object_store import new_prefix

from microcosmos_server.attempts import claim as claims
from microcosmos_server.attempts.claim import claimed
from microcosmos_server.storage import mark
from microcosmos_server.storage.artifacts import Artifacts

pytestmark = pytest.mark.postgresql


@pytest.fixture
def services(services, object_store):
    """The services of the tests, with files in S3."""
    there = replace(services, artifacts=Artifacts(new_prefix()))
    mark.leave(there.sessions, there.artifacts)
    return there


@pytest.fixture
def held(services, run_id):
    return lambda stop=lambda: False: claimed(services, run_id, "worker", stop)


@pytest.fixture
def saved(held, row):
    """A run that its worker left with a checkpoint."""
    with held() as attempt:
        attempt.record(reports.report(1), 1.0)
        attempt.save(1, b"state")
        attempt.requeue()
    return row().attempt


def test_a_run_waits_for_its_checkpoint(held, saved, object_store):
    object_store.failing = "/runs/"
    Timer(0.5, setattr, (object_store, "failing", None)).start()
    with held() as attempt:
        assert attempt.restore() == b"state"
    assert object_store.failed > 0


@pytest.mark.long
@pytest.mark.parametrize(
    ("failing", "status"), [("", "queued"), ("/runs/", "paused")], ids=["all", "one file"]
)
def test_a_checkpoint_that_stays_unreadable_counts_no_attempt(
    held, saved, object_store, row, monkeypatch, failing, status
):
    monkeypatch.setattr(claims, "OUTAGE_SECONDS", 0.0)
    object_store.failing = failing
    with held() as attempt:
        attempt.restore()
        pytest.fail("the checkpoint was restored")
    assert (row().status, row().attempt, row().worker) == (status, saved + 1, None)
    assert (row().attempts_without_checkpoint, row().error) == (status == "paused", None)
    if status == "paused":
        assert row().warning.startswith("Its checkpoint cannot be read")
    object_store.failing = None


def test_a_worker_that_has_to_stop_does_not_wait(held, saved, object_store, row):
    object_store.failing = ""
    with held(lambda: True) as attempt:
        attempt.restore()
        pytest.fail("the checkpoint was restored")
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


def test_the_last_checkpoint_waits_for_the_store(held, saved, object_store, row):
    with held() as attempt:
        attempt.record(reports.report(2), 1.0)
        object_store.failing = ""
        Timer(0.5, setattr, (object_store, "failing", None)).start()
        attempt.end(True, 2, lambda: b"the end")
    assert (row().status, row().checkpoint_generation, row().warning) == ("finished", 2, None)
