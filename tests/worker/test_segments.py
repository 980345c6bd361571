"""A run whose checkpoints are in segments dies in different moments, and keeps its bytes."""

from dataclasses import replace

import pytest
from small_spec import SMALL_RUN
from sqlalchemy import select, update

from microcosmos.archive import export, file
from microcosmos.build import local
from microcosmos.spec import parse
from microcosmos_server.attempts.checkpoints import newest_intact
from microcosmos_server.attempts.claim import claim
from microcosmos_server.creatures import initial
from microcosmos_server.maintenance import backup
from microcosmos_server.runs.submission import submit
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.tables import SEGMENT, Artifact, Creature, Elite, Run
from microcosmos_worker.evolution import compute

SPEC = parse(SMALL_RUN | {"search": {"generations": 6, "batch": 8, "block": 8}})


class Killed(BaseException):
    """The end of a worker that saves nothing."""


@pytest.fixture
def services(services):
    """Services of a worker that saves each generation, in segments."""
    settings = services.settings.model_copy(update={"segment_bytes": 64})
    return replace(services, settings=settings)


@pytest.fixture
def run_id(services):
    return submit(services, SPEC)[0].id


@pytest.fixture
def dying(services, monkeypatch):
    """Computes until a number of files with an ending are written, and dies at the next."""

    def die(run_id, ending, after):
        write, written = Artifacts.write, []

        def counted(self, path, data):
            if path.endswith(ending):
                if len(written) == after:
                    raise Killed
                written.append(path)
            return write(self, path, data)

        with monkeypatch.context() as patch:
            patch.setattr(Artifacts, "write", counted)
            with pytest.raises(Killed):
                compute(claim(services, run_id, "worker"))

    return die


def test_killed_within_a_checkpoint_a_run_ends_with_the_same_bytes(
    services, run_id, row, dying, tmp_path
):
    for moment in ((".head", 2), (".segment", 1), (".head", 1), (".head", 0)):
        dying(run_id, *moment)
        assert row().status == "running"
    compute(claim(services, run_id, "worker"))
    assert (row().status, row().generation) == ("finished", 6)
    assert local.evolve(SPEC, tmp_path / "undisturbed.h5")
    found = newest_intact(services, run_id)
    assert found.data == (tmp_path / "undisturbed.h5").read_bytes()
    assert len(found.segments) > 10
    with services.sessions.read() as session:
        named = session.scalars(select(Artifact.path).where(Artifact.kind == SEGMENT)).all()
    assert {one.path for one in found.segments.values()} <= set(named)
    assert backup.check(services)[1] == []


@pytest.mark.long
def test_a_run_is_under_the_terms_of_the_creatures_that_it_begins_from(
    services, run_id, dying, tmp_path
):
    terms = {"licence": "CC-BY-NC-4.0", "credit": ["Ada"]}
    chosen = select(Creature.sha256).join(Elite, Elite.creature == Creature.sha256)
    compute(claim(services, run_id, "worker"))
    with services.sessions.write.begin() as session:
        (name,) = session.scalars(chosen.order_by(Creature.sha256).limit(1))
        session.execute(update(Creature).where(Creature.sha256 == name).values(**terms))
    search = SMALL_RUN["search"] | {"generations": 3, "batch": 8, "block": 8}
    spec = parse(SMALL_RUN | {"seed": 9, "search": search | {"initial": [name]}})
    second = submit(services, spec)[0].id
    dying(second, ".head", 2)  # The next attempt finds the terms in the file.
    compute(claim(services, second, "worker"))
    found = newest_intact(services, second)
    assert found.segments
    assert export.terms(file.load(found.data)[1]) == terms
    with services.sessions.read() as session:
        (first,) = initial.files(session, [name])
        assert session.get_one(Run, second).status == "finished"
        mine = select(Creature.licence, Creature.credit).join(
            Elite, Elite.creature == Creature.sha256
        )
        rows = session.execute(mine.where(Elite.run_id == second)).all()
    assert rows
    assert all(tuple(row) == ("CC-BY-NC-4.0", ["Ada"]) for row in rows)
    assert local.evolve(spec, tmp_path / "local.h5", initial=[first])
    assert found.data == (tmp_path / "local.h5").read_bytes()
