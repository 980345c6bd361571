"""Choose the creatures of the tank: the best and the most different ones of the latest runs."""

from collections.abc import Iterator
from itertools import chain, islice, zip_longest
from typing import Any

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session

from ..archives import elites
from ..runs.lifecycle import NOT_IN_BIN
from ..tables import RUNNING, Creature, Elite, Run
from .schemas import Swimmer

RUNS = 8
CANDIDATES = 1000
"""The best elites of a run, among which the most different ones are chosen."""
SHARE = 2
"""A running run has so many creatures in the tank for each one of another."""


def latest_runs(session: Session) -> list[Run]:
    """Return the runs that have elites: those that run, then the latest others."""
    with_elites = select(Run).where(NOT_IN_BIN, Run.best.is_not(None))
    latest = with_elites.order_by((Run.status == RUNNING).desc(), Run.created_at.desc(), Run.id)
    return list(session.scalars(latest.limit(RUNS)))


def choose(session: Session, runs: list[Run], count: int) -> list[Swimmer]:
    """Return at most so many creatures that have a pose stream, each run's best one first."""
    turns: list[Iterator[Swimmer]] = []
    for run in runs:
        mine = iter(_of_run(session, run, count))
        turns += [mine] * (SHARE if run.status == RUNNING else 1)
    in_turn = filter(None, chain.from_iterable(zip_longest(*turns)))
    once = {one.creature: one for one in reversed(list(in_turn))}
    return list(islice(reversed(once.values()), count))


def _of_run(session: Session, run: Run, count: int) -> list[Swimmer]:
    trusted = Creature.trusted.is_not(False)
    best = elites.as_of(run, run.generation).where(trusted, Creature.poses.is_not(None))
    best = best.order_by(None).order_by(Elite.fitness.desc(), Elite.cell).limit(CANDIDATES)
    found = session.execute(best).all()
    if not found:
        return []
    chosen = most_different(np.array([one.descriptors for one in found], float), count)
    return [_swimmer(run, found[place]) for place in chosen]


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


def _swimmer(run: Run, elite: Any) -> Swimmer:
    return Swimmer(
        creature=elite.creature,
        run=run.id,
        generation=elite.generation,
        fitness=elite.fitness,
    )
