"""How far runs are, as people see it: rows with their curves condensed."""

from collections import defaultdict
from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import and_, or_, select
from sqlalchemy.orm import Session

from .models import FAILED, RUNNING, Generation, Run
from .schemas import RunRead

POINTS = 32


def evenly(last: int, points: int) -> list[int]:
    """At most so many generations, evenly spaced from 1 to the last, both among them."""
    if last <= points:
        return list(range(1, last + 1))
    return sorted({1 + round(i * (last - 1) / (points - 1)) for i in range(points)})


def read_runs(session: Session, runs: Sequence[Run]) -> list[RunRead]:
    curves = _curves(session, runs)
    return [_read(run, curves[run.id]) for run in runs]


def read_run(session: Session, run: Run) -> RunRead:
    return read_runs(session, [run])[0]


def _curves(session: Session, runs: Sequence[Run]) -> dict[UUID, list[Generation]]:
    """A few generations of each run, all in one query."""
    curves: dict[UUID, list[Generation]] = defaultdict(list)
    wanted = [
        and_(
            Generation.run_id == run.id,
            Generation.generation.in_(evenly(run.generation, POINTS)),
        )
        for run in runs
        if run.generation
    ]
    if wanted:
        rows = select(Generation).where(or_(*wanted)).order_by(Generation.generation)
        for row in session.scalars(rows):
            curves[row.run_id].append(row)
    return curves


def _read(run: Run, curve: list[Generation]) -> RunRead:
    generations = run.spec["search"]["generations"]
    evaluations = generations * run.spec["search"]["batch"]
    rate = _rate(curve)
    left = max(0, evaluations - run.evaluations)
    columns = {column.key: getattr(run, column.key) for column in Run.__table__.columns}
    columns["error"] = run.error if run.status == FAILED else None
    return RunRead(
        **{name: columns[name] for name in RunRead.model_fields if name in columns},
        generations=generations,
        progress=min(1.0, run.generation / generations),
        eta_seconds=left / rate if rate and run.status == RUNNING else None,
        evaluations_per_second=rate,
        sparkline=[row.qd_score for row in curve if row.qd_score is not None],
    )


def _rate(curve: list[Generation]) -> float | None:
    """Evaluations a second between the last two points; the first one had to compile."""
    if not curve:
        return None
    last = curve[-1]
    evaluations, seconds = last.evaluations, last.seconds
    if len(curve) > 1:
        evaluations, seconds = evaluations - curve[-2].evaluations, seconds - curve[-2].seconds
    return evaluations / seconds if seconds > 0 else None
