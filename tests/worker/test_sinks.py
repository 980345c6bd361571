"""A worker sends its run to the sinks of its settings; the record of the run names them."""

from dataclasses import replace

import pytest
from small_spec import SMALL_RUN
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from microcosmos.sinks import delivery
from microcosmos.spec import parse
from server.attempts.claim import claim
from server.runs.submission import submit
from worker.evolution import compute

SPEC = parse(SMALL_RUN)


class Died(Exception):
    """The end of a worker that saves nothing."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(delivery, "PATIENCE", 100.0)
    return tmp_path / "events"


@pytest.fixture
def services(services, folder):
    """Services of a worker with a sink, which saves the first generation and the last."""
    changed = {"checkpoint_interval": 3600.0, "sinks": f"tensorboard:{folder}"}
    return replace(services, settings=services.settings.model_copy(update=changed))


@pytest.fixture
def run_id(services):
    return submit(services, SPEC)[0].id


@pytest.mark.long
def test_a_run_whose_worker_died_continues_its_record(services, run_id, row, folder):
    found = claim(services, run_id, "worker")

    def die():
        if row().generation == 3:
            raise Died
        return False

    with pytest.raises(Died):
        compute(replace(found, stop_requested=die))
    compute(replace(claim(services, run_id, "worker"), services=services))
    assert row().status == "finished"
    assert row().sinks == [f"tensorboard:{folder}"]
    (written,) = folder.iterdir()
    assert written.name == f"quality-diversity-{run_id}"
    events = EventAccumulator(str(written))
    events.Reload()
    assert [one.step for one in events.Scalars("qd_score")] == [1, 2, 3, 4]
    assert (written / "run.h5").stat().st_size
    assert (written / "best.json").stat().st_size
