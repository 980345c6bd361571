"""Routes of the tank: its creatures, and the pose streams of many creatures at once."""

from collections.abc import Iterator
from itertools import chain, islice, zip_longest
from typing import Annotated, NamedTuple
from uuid import UUID

import numpy as np
from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive import poses
from microcosmos.version import VERSION

from ..archives import elites
from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import sends
from ..core.schemas import Wire
from ..runs.lifecycle import NOT_IN_BIN
from ..services.services import ServicesDep
from ..tables import RUNNING, Creature, Elite, InstallationState, Run
from ..workers.registry import run_brief
from ..workers.schemas import RunBrief


class Swimmer(Wire):
    """A creature in the tank, from one of its runs."""

    creature: str
    run: UUID
    generation: int
    """The generation in which the creature entered the archive."""
    fitness: float


class Tank(Wire):
    """The best and the most different creatures of the latest runs, each once."""

    swimmers: list[Swimmer]
    """Sorted: a smaller tank takes the first ones."""
    runs: list[RunBrief]
    """The runs from which they come: running ones first, then the latest."""


RUNS = 8
CANDIDATES = 1000
"""The best elites of a run, among which the most different ones are chosen."""
SHARE = 2
"""Creatures that a running run gets in each round; any other run gets one."""


def latest_runs(session: Session) -> list[Run]:
    """Return the runs that have elites: those that run, then the latest others."""
    with_elites = select(Run).where(NOT_IN_BIN, Run.best.is_not(None))
    latest = with_elites.order_by((Run.status == RUNNING).desc(), Run.created_at.desc(), Run.id)
    return list(session.scalars(latest.limit(RUNS)))


def choose(session: Session, runs: list[Run], count: int) -> list[Swimmer]:
    """Return at most `count` creatures with pose streams, first the best one of each run."""
    turns: list[Iterator[Swimmer]] = []
    for run in runs:
        mine = iter(_of_run(session, run, count))
        turns += [mine] * (SHARE if run.status == RUNNING else 1)
    in_turn = filter(None, chain.from_iterable(zip_longest(*turns)))
    distinct = {one.creature: one for one in reversed(list(in_turn))}
    return list(islice(reversed(distinct.values()), count))


def _of_run(session: Session, run: Run, count: int) -> list[Swimmer]:
    # A creature without an audit is shown; one that failed it may owe its speed to the
    # simulation.
    trusted = Creature.trusted.is_not(False)
    best = elites.as_of(run, run.generation).where(trusted, Creature.poses.is_not(None))
    best = best.order_by(None).order_by(Elite.fitness.desc(), Elite.cell).limit(CANDIDATES)
    found = session.execute(best).all()
    if not found:
        return []
    chosen = most_different(np.array([one.descriptors for one in found], float), count)
    return [
        Swimmer(
            creature=one.creature, run=run.id, generation=one.generation, fitness=one.fitness
        )
        for one in (found[place] for place in chosen)
    ]


def most_different(places: np.ndarray, count: int) -> list[int]:
    """Return the rows of `places` (n, axes) that spread most, the first one first.

    Each next row is the one with the largest distance from all before (farthest-first
    traversal: T. F. Gonzalez, Theor. Comput. Sci. 38, 1985), weighted by its place: earlier
    rows are better ones. An axis is measured by the rank of its values, whatever its scale.
    """
    ranks = places.argsort(0, kind="stable").argsort(0) / len(places)
    weight = np.linspace(1.0, 0.25, len(places))
    chosen, nearest = [0], np.full(len(places), np.inf)
    while len(chosen) < min(count, len(places)):
        nearest = np.minimum(nearest, np.linalg.norm(ranks - ranks[chosen[-1]], axis=1))
        nearest[chosen] = -1.0
        chosen.append(int((nearest * weight).argmax()))
    return chosen


router = APIRouter(prefix="/tank", tags=["creatures"])
JSON = "application/json"
MAX_CREATURES = 100
DIGESTS = rf"^[0-9a-f]{{64}}(,[0-9a-f]{{64}}){{0,{MAX_CREATURES - 1}}}$"


class Latest(NamedTuple):
    """The runs of the tank and the count of verdicts: the tank depends on nothing else."""

    runs: list[Run]
    verdicts: int


def _latest(services: ServicesDep) -> Latest:
    with services.sessions.read() as session:
        verdicts = session.scalars(select(InstallationState.verdicts)).one()
        return Latest(latest_runs(session), verdicts)


@router.get("", response_model=Tank, dependencies=[MAY_READ])
async def read_tank(
    request: Request,
    services: ServicesDep,
    latest: Annotated[Latest, Depends(_latest)],
    limit: Annotated[int, Query(ge=1, le=MAX_CREATURES)] = 60,
) -> Response:
    """Return the best and the most different creatures of the latest runs."""
    briefs = [run_brief(run) for run in latest.runs]

    def make() -> bytes:
        with services.sessions.read() as session:
            swimmers = choose(session, latest.runs, limit)
        return Tank(swimmers=swimmers, runs=briefs).model_dump_json().encode()

    rewinds = [run.rewinds for run in latest.runs]
    tag = tag_of(VERSION, limit, briefs, rewinds, latest.verdicts)
    return await respond(request, tag, make, JSON, {})


@router.get("/poses", **sends("application/octet-stream"), dependencies=[MAY_READ])
def read_tank_poses(
    services: ServicesDep, creatures: Annotated[str, Query(pattern=DIGESTS)]
) -> Response:
    """Return the pose streams of creatures, whose names are separated by commas.

    The length of each stream precedes it, as a little-endian uint32. Creatures without a
    stream are left out.
    """
    stored = select(Creature.poses).where(Creature.sha256.in_(creatures.split(",")))
    with services.sessions.read() as session:
        found = session.scalars(stored.order_by(Creature.sha256)).all()
    return Response(poses.batch(found), media_type="application/octet-stream")
