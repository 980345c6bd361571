"""Read runs for the API: columns, rates, and a sparkline."""

from collections import defaultdict
from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import and_, case, func, or_, select
from sqlalchemy.orm import Session

from ..auth import tokens
from ..estimates import position
from ..services.services import Services
from ..tables import FAILED, RUNNING, Elite, Generation, Result, Run
from ..workers.registry import progress
from .curves import thinned
from .schemas import ForkedFrom, RunRead

# A list reads the curves of 200 runs at once.
SPARKLINE_POINTS = 32


def read_runs(
    services: Services, session: Session, runs: Sequence[Run], queue: bool = True
) -> list[RunRead]:
    """Read runs; without the `queue`, queued ones have no reason for waiting."""
    curves = _curves(session, runs)
    reasons = position.reasons(services, session, runs) if queue else {}
    names = tokens.owner_names(session, (run.owner for run in runs))
    faces = faces_of(session, runs)
    return [
        _read(
            run,
            curves[run.id],
            waiting_reason=reasons.get(run.id),
            owner=names.get(run.owner),
            face=faces.get(run.id),
        )
        for run in runs
    ]


def read_run(services: Services, session: Session, run: Run) -> RunRead:
    return read_runs(services, session, [run])[0]


def _curves(session: Session, runs: Sequence[Run]) -> dict[UUID, list[Generation]]:
    curves: dict[UUID, list[Generation]] = defaultdict(list)
    wanted = [
        and_(
            Generation.run_id == run.id,
            Generation.generation.in_(thinned(run.generation, SPARKLINE_POINTS)),
        )
        for run in runs
        if run.generation
    ]
    if wanted:
        rows = select(Generation).where(or_(*wanted)).order_by(Generation.generation)
        for row in session.scalars(rows):
            curves[row.run_id].append(row)
    return curves


def faces_of(session: Session, runs: Sequence[Run]) -> dict[UUID, str]:
    """Return a creature of each run that has one: its best elite, or its newest result's.

    The run of a share ends at a generation, so later elites do not count.
    """
    last = case({run.id: run.generation for run in runs}, value=Run.id) if runs else 0
    best = (
        select(Elite.creature)
        .where(Elite.run_id == Run.id, Elite.fitness.is_not(None), Elite.generation <= last)
        .order_by(Elite.fitness.desc(), Elite.cell.desc())
        .limit(1)
    )
    newest = (
        select(Result.creature)
        .where(Result.run_id == Run.id, Result.creature.is_not(None))
        .order_by(Result.number.desc())
        .limit(1)
    )
    face = func.coalesce(best.scalar_subquery(), newest.scalar_subquery())
    begun = Run.id.in_([run.id for run in runs if run.generation])
    found = session.execute(select(Run.id, face).where(begun))
    return {run: creature for run, creature in found if creature}


def _read(run: Run, curve: list[Generation], **more: Any) -> RunRead:
    generations, evaluations = _rates(run, curve)
    remaining = max(0, run.generations - run.generation)
    fork = None
    if run.n_initial is not None:
        fork = ForkedFrom(run=run.forked_from, creatures=run.n_initial)
    columns = {column.key: getattr(run, column.key) for column in Run.__table__.columns}
    if run.status != FAILED:
        columns |= {"error": None, "error_details": None}
    columns["forked_from"] = fork
    return RunRead(
        **{name: columns[name] for name in RunRead.model_fields if name in columns} | more,
        progress=progress(run),
        eta_seconds=remaining / generations if generations and run.status == RUNNING else None,
        evaluations_per_second=evaluations,
        sparkline=[row.qd_score for row in curve if row.qd_score is not None],
    )


def _rates(run: Run, curve: list[Generation]) -> tuple[float | None, float | None]:
    """Return generations and evaluations per second, since the last point of a running run.

    For other runs, since the first generation, which had to compile.
    """
    names = ("generation", "evaluations", "seconds")
    points = [Generation(generation=0, evaluations=0, seconds=0.0), *curve]
    start = (
        points[-2 if run.status == RUNNING or len(points) < 3 else 1] if curve else points[0]
    )
    first, last = ([getattr(row, name) for name in names] for row in (start, points[-1]))
    generations, evaluations, seconds = (b - a for a, b in zip(first, last, strict=True))
    return (generations / seconds, evaluations / seconds) if seconds > 0 else (None, None)
