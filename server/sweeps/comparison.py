"""Figures of the runs of a sweep at one generation, which all of them have reached."""

from collections.abc import Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import case, select
from sqlalchemy.orm import Session

from ..runs.curves import numbers
from ..tables import CANCELLED, FAILED, FINISHED, Generation, Run

FIGURES = ("qd_score", "coverage", "best")
COLUMNS = (*FIGURES, "evaluations")


def common_generation(runs: Sequence[Any]) -> int | None:
    """Return the last generation that every started run has reached; None before the first.

    A finished run counts as complete, so it holds nobody back. Failed and cancelled runs do
    not count where others go on or have finished.
    """
    started = [run for run in runs if run.generation > 0]
    active = [run for run in started if run.status not in (FINISHED, FAILED, CANCELLED)]
    finished = [run.generation for run in started if run.status == FINISHED]
    reached = [run.generation for run in active or started]
    if not active and finished:
        return max(finished)
    return min(reached, default=None)


def figures_at(
    session: Session, runs: Sequence[Any], generation: int | None, searched: bool
) -> dict[UUID, dict[str, float]]:
    """Return the figures of each run at a generation; of a shorter finished run its last ones.

    Runs whose result is a table add the numbers of their newest summary until then.
    """
    if generation is None:
        return {}
    compared = [
        run.id for run in runs if run.generation >= generation or run.status == FINISHED
    ]
    last = case((Run.generation < generation, Run.generation), else_=generation)
    at = Generation.generation == last if searched else Generation.generation <= last
    columns = [getattr(Generation, name) for name in COLUMNS]
    rows = (
        select(Generation.run_id, *columns, Generation.summary)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.id.in_(compared), at)
        .order_by(Generation.generation)
    )
    found: dict[UUID, dict[str, float]] = {}
    for run_id, *values, summary in session.execute(rows):
        figures = dict(zip(COLUMNS, values, strict=True))
        of_table = {} if searched else numbers(summary or {})
        found[run_id] = {**found.get(run_id, {}), **known(figures), **of_table}
    return found


def known(figures: Mapping[Any, float | None]) -> dict[str, float]:
    return {name: value for name, value in figures.items() if value is not None}
