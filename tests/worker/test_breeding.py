"""A run with choices, whose worker dies: the export repeats the bytes of its archive."""

import json
from dataclasses import replace

import pytest
from small_spec import SMALL_RUN
from sqlalchemy import select

from microcosmos.archive import choices
from microcosmos.build import local
from microcosmos.spec import parse
from server.attempts.checkpoints import newest_intact
from server.attempts.claim import claim
from server.choices import choosing
from server.creatures import initial
from server.runs.submission import submit
from server.tables import Elite, Run
from worker.evolution import compute

SPEC = parse(SMALL_RUN | {"search": {"generations": 5, "batch": 8, "block": 8}})


class Died(Exception):
    """The end of a worker that saves nothing."""


@pytest.fixture
def services(services):
    """Services of a worker that saves the first generation and the last."""
    settings = services.settings.model_copy(update={"checkpoint_interval": 3600.0})
    return replace(services, settings=settings)


@pytest.fixture
def run_id(services):
    return submit(services, SPEC)[0].id


@pytest.fixture
def attempt(services, run_id, row):
    """Claims the run for an attempt that calls `act` during a generation."""

    def claimed(during, act):
        found = claim(services, run_id, "worker")

        def look():
            if row().begun_generation == during:
                act()
            return False

        return replace(found, stop_requested=look)

    return claimed


def choose(services, run_id):
    """Choose the first of the run's elites."""
    with services.sessions.write.begin() as session:
        elites = select(Elite.creature).where(Elite.run_id == run_id).order_by(Elite.cell)
        name = session.scalars(elites).first()
        choosing.choose(session, session.get_one(Run, run_id), [name])


def counted(services, run_id):
    """The rows of the choices, and the files of their creatures."""
    with services.sessions.read() as session:
        rows = choosing.counted(session, session.get_one(Run, run_id))
        return [(one.generation, one.creature) for one in rows], initial.files(
            session, sorted({one.creature for one in rows})
        )


@pytest.mark.long
def test_a_choice_counts_from_the_first_generation_that_no_worker_began(
    services, run_id, row, attempt, tmp_path
):
    def die():
        choose(services, run_id)
        raise Died

    with pytest.raises(Died):
        compute(attempt(3, die))
    assert (row().generation, row().begun_generation, row().checkpoint_generation) == (2, 3, 1)
    compute(attempt(None, None))  # It repeats generations 2 and 3 without the choice.
    assert row().status == "finished"
    rows, files = counted(services, run_id)
    assert [generation for generation, _ in rows] == [4]
    data, _, _ = newest_intact(services, run_id)
    given = choices.parse(json.dumps(choices.document(rows, files)).encode())
    path = tmp_path / "repeated.h5"
    assert local.evolve(SPEC, path, choices=given)
    assert path.read_bytes() == data
