"""Curves over the generations of a run, thinned for a screen."""

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive.curves import CORRECTED
from microcosmos.archive.report import SPECIES, curves_of, figure

from ..tables import Generation


def thinned(last: int, points: int) -> list[int]:
    """Return about `points` generations, evenly spaced from 1 to the last."""
    if last <= points:
        return list(range(1, last + 1))
    return sorted({1 + round(i * (last - 1) / (points - 1)) for i in range(points)})


def summaries(
    session: Session, run_id: UUID, generations: Sequence[int]
) -> dict[str, list[float | None]]:
    """Return the numbers in the summaries as columns, an entry for each of the generations.

    Not every generation has every number: an entry is the newest since the previous entry.
    Counts are added up instead.
    """
    mine = (Generation.run_id == run_id) & Generation.summary.is_not(None)
    # Read once from the start: counts between two points add up.
    rows = select(Generation.generation, Generation.summary).where(mine)
    points: list[dict[str, float]] = [{} for _ in generations]
    ordered = rows.order_by(Generation.generation).execution_options(yield_per=1000)
    for generation, summary in session.execute(ordered):
        place = bisect_left(generations, generation)
        for name, value in curves_of(summary).items() if place < len(points) else ():
            known = figure(name)
            counted = points[place].get(name, 0) if known and known.adds else 0
            points[place][name] = counted + value
    names = dict.fromkeys(name for point in points for name in point)
    return {name: [point.get(name) for point in points] for name in names}


def corrected_at(session: Session, run_id: UUID, generation: int) -> dict[str, float | None]:
    """Return the figures of the last reevaluation of elites up to a generation."""
    before = (Generation.run_id == run_id) & (Generation.generation <= generation)
    known = before & Generation.summary[CORRECTED[0]].as_float().is_not(None)
    rows = select(Generation.summary).where(known).order_by(Generation.generation.desc())
    summary = session.scalars(rows.limit(1)).one_or_none() or {}
    return {name: summary.get(name) for name in CORRECTED}


def coverage_at(session: Session, run_id: UUID, generation: int) -> float:
    """Return the coverage as of a generation, 0 before the first."""
    before = (Generation.run_id == run_id) & (Generation.generation <= generation)
    rows = select(Generation.coverage).where(before).order_by(Generation.generation.desc())
    return session.scalars(rows.limit(1)).first() or 0.0


def species(session: Session, run_id: UUID, wanted: list[int]) -> dict[str, list[Any]]:
    """Return numbers and sizes of the species, for the generations that have any."""
    mine = (Generation.run_id == run_id) & Generation.generation.in_(wanted)
    rows = select(Generation.generation, Generation.summary).where(mine)
    columns: dict[str, list[Any]] = {"generation": [], "number": [], "members": []}
    for generation, summary in session.execute(rows.order_by(Generation.generation)):
        if sizes := SPECIES.of(summary):
            columns["generation"].append(generation)
            columns["number"].append(list(map(int, sizes)))
            columns["members"].append(list(map(int, sizes.values())))
    return columns
