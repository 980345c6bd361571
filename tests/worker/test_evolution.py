"""A run whose worker dies: its record in sinks, and the export of its choices."""

import json
from dataclasses import replace

import numpy as np
import pytest
from small_spec import SMALL_RUN
from sqlalchemy import select
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from microcosmos.archive import choices
from microcosmos.archive.curves import CORRECTED
from microcosmos.build import local
from microcosmos.sinks import delivery
from microcosmos.spec import parse
from microcosmos.statistics import records as statistics
from microcosmos_server.attempts.checkpoints import newest_intact
from microcosmos_server.attempts.claim import claim
from microcosmos_server.choices import choosing
from microcosmos_server.creatures import initial
from microcosmos_server.forks.routes import extend, longer
from microcosmos_server.runs.submission import submit
from microcosmos_server.statistics.routes import of_runs, records
from microcosmos_server.tables import Elite, Run
from microcosmos_worker.evolution import compute

pytestmark = pytest.mark.long
SPEC = parse(SMALL_RUN | {"search": {"generations": 5, "batch": 8, "block": 8}})


class Died(Exception):
    """The end of a worker that saves nothing."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of the sink."""
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


@pytest.fixture
def attempt(services, run_id, row):
    """Claims the run for an attempt that calls `act` during a generation."""

    def claimed(during=-1, act=None):
        def look():
            if row().begun_generation == during:
                act()
            return False

        return replace(
            claim(services, run_id, "worker"), services=services, stop_requested=look
        )

    return claimed


def choose(services, run_id):
    """Choose the first of the run's elites."""
    with services.sessions.write.begin() as session:
        elites = select(Elite.creature).where(Elite.run_id == run_id).order_by(Elite.cell)
        name = session.scalars(elites).first()
        choosing.choose(session, session.get_one(Run, run_id), [name])


def test_a_choice_counts_from_the_first_generation_that_no_worker_began(
    services, run_id, row, attempt, folder, tmp_path
):
    """The export repeats the bytes of the archive; the sink has each generation once."""

    def die():
        choose(services, run_id)
        raise Died

    with pytest.raises(Died):
        compute(attempt(3, die))
    assert (row().generation, row().begun_generation, row().checkpoint_generation) == (2, 3, 1)
    compute(attempt())  # It repeats generations 2 and 3 without the choice.
    assert row().status == "finished"
    with services.sessions.read() as session:
        rows = choosing.counted(session, session.get_one(Run, run_id))
        files = initial.files(session, sorted({one.creature for one in rows}))
    assert [one.generation for one in rows] == [4]
    counted = [(one.generation, one.creature) for one in rows]
    given = choices.parse(json.dumps(choices.document(counted, files)).encode())
    path = tmp_path / "repeated.h5"
    assert local.evolve(SPEC, path, choices=given)
    assert path.read_bytes() == newest_intact(services, run_id).data
    see_the_record(row(), folder)


def see_the_record(run, folder):
    assert run.sinks == [f"tensorboard:{folder}"]
    (written,) = folder.iterdir()
    assert written.name == f"quality-diversity-{run.id}"
    events = EventAccumulator(str(written))
    events.Reload()
    assert [one.step for one in events.Scalars("qd_score")] == [1, 2, 3, 4, 5]
    assert (written / "run.h5").stat().st_size
    assert (written / "best.json").stat().st_size


def test_an_extended_run_takes_back_the_reevaluation_at_its_first_end(services):
    search = {"generations": 4, "batch": 8, "block": 8}
    again = {"reevaluation": {"every": 3, "samples": 2}}
    run_id = submit(services, parse(SMALL_RUN | {"search": search | again}))[0].id
    compute(claim(services, run_id, "worker"))
    with services.sessions.write.begin() as session:
        run = session.get_one(Run, run_id)
        assert run.evaluations > 4 * 8
        extend(session, run, longer(run, 4))
    compute(claim(services, run_id, "worker"))
    file = statistics.read(newest_intact(services, run_id).data, "the file")
    with services.sessions.read() as session:
        question = of_runs(session, [run_id], "")
        (found,) = records(session, question, last=False)
        (some,) = records(session, question, last=True)
        assert session.get_one(Run, run_id).evaluations == found.evaluations[-1]
    for name in ("evaluations", *CORRECTED):
        np.testing.assert_array_equal(found.curves[name], file.curves[name])
    for one in (found, file):
        assert one.searched.tolist() == list(range(8, 65, 8))
    assert some.searched.tolist() == [8, 24, 48, 64]  # Of generations 1, 3, 6 and 8.


def test_a_run_whose_checkpoint_has_another_spec_waits_for_a_person(
    services, run_id, attempt, row
):
    """As after an upgrade: another attempt would be refused, too."""

    def die():
        raise Died

    with pytest.raises(Died):
        compute(attempt(during=2, act=die))
    assert row().checkpoint_generation == 1
    with services.sessions.write.begin() as session:
        run = session.get_one(Run, run_id)
        run.status, run.worker = "queued", None
        run.spec = run.spec | {"world": run.spec["world"] | {"viscosity": 0.123}}
    compute(attempt())
    assert row().status == "paused"
    assert "`spec` in the file must be the run's own" in row().warning
    assert row().checkpoint_generation == 1
