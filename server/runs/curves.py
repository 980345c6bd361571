"""Curves over the generations of a run, thinned for a screen."""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..tables import CORRECTED, Generation

COUNT_PREFIX = "infeasible: "
"""Prefix of counts per generation, which are added up between two points."""


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
    rows = select(Generation.generation, Generation.summary).where(mine)
    points: list[dict[str, float]] = [{} for _ in generations]
    ordered = rows.order_by(Generation.generation).execution_options(yield_per=1000)
    for generation, summary in session.execute(ordered):
        place = bisect_left(generations, generation)
        for name, value in numbers(summary or {}).items() if place < len(points) else ():
            counted = points[place].get(name, 0) if name.startswith(COUNT_PREFIX) else 0
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


def numbers(summary: Mapping[str, Any]) -> dict[str, float]:
    return {
        name: value
        for name, value in summary.items()
        if isinstance(value, int | float) and not isinstance(value, bool)
    }


def species(session: Session, run_id: UUID, wanted: list[int]) -> dict[str, list[Any]]:
    """Return numbers and sizes of the species, for the generations that have any."""
    mine = (Generation.run_id == run_id) & Generation.generation.in_(wanted)
    rows = select(Generation.generation, Generation.summary).where(mine)
    columns: dict[str, list[Any]] = {"generation": [], "number": [], "members": []}
    for generation, summary in session.execute(rows.order_by(Generation.generation)):
        recorded = (summary or {}).get("species")
        if isinstance(recorded, str):
            pairs = [pair.partition(":") for pair in recorded.split()]
            columns["generation"].append(generation)
            columns["number"].append([int(number) for number, _, _ in pairs])
            columns["members"].append([int(members) for _, _, members in pairs])
    return columns
