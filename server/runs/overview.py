"""How far runs are, as people see it: rows with their curves condensed."""

from collections import defaultdict
from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import and_, or_, select
from sqlalchemy.orm import Session

from ..auth import tokens
from ..estimates import position
from ..services.services import Services
from ..tables import FAILED, RUNNING, Generation, Run
from ..workers.brief import progress
from .schemas import ForkedFrom, RunRead

POINTS = 32


def evenly(last: int, points: int) -> list[int]:
    """At most so many generations, evenly spaced from 1 to the last, both among them."""
    if last <= points:
        return list(range(1, last + 1))
    return sorted({1 + round(i * (last - 1) / (points - 1)) for i in range(points)})


def read_runs(
    services: Services, session: Session, runs: Sequence[Run], queue: bool = True
) -> list[RunRead]:
    """Read runs for the API; without the `queue`, queued ones have no reason for waiting."""
    curves = _curves(session, runs)
    reasons = position.reasons(services, session, runs) if queue else {}
    named = tokens.names(session, (run.owner for run in runs))
    return [
        _read(run, curves[run.id], reasons.get(run.id), named.get(run.owner)) for run in runs
    ]


def read_run(services: Services, session: Session, run: Run) -> RunRead:
    return read_runs(services, session, [run])[0]


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


def _read(run: Run, curve: list[Generation], reason: str | None, owner: str | None) -> RunRead:
    generations, evaluations = _rates(run, curve)
    left = max(0, run.generations - run.generation)
    columns = {column.key: getattr(run, column.key) for column in Run.__table__.columns}
    columns |= {"error": run.error if run.status == FAILED else None, "owner": owner}
    columns["forked_from"] = forked(run)
    return RunRead(
        **{name: columns[name] for name in RunRead.model_fields if name in columns},
        waiting_reason=reason,
        progress=progress(run),
        eta_seconds=left / generations if generations and run.status == RUNNING else None,
        evaluations_per_second=evaluations,
        sparkline=[row.qd_score for row in curve if row.qd_score is not None],
    )


def forked(run: Run) -> ForkedFrom | None:
    """Where it began, if it is a fork."""
    return (
        None
        if run.n_initial is None
        else ForkedFrom(run=run.forked_from, creatures=run.n_initial)
    )


def _rates(run: Run, curve: list[Generation]) -> tuple[float | None, float | None]:
    """Generations and evaluations a second: at present, and since the first generation for a
    run that nobody carries out. The first one had to compile.
    """
    names = ("generation", "evaluations", "seconds")
    first, last = ([getattr(row, name) for name in names] for row in _ends(run, curve))
    generations, evaluations, seconds = (b - a for a, b in zip(first, last, strict=True))
    return (generations / seconds, evaluations / seconds) if seconds > 0 else (None, None)


def _ends(run: Run, curve: list[Generation]) -> tuple[Generation, Generation]:
    begin = Generation(generation=0, evaluations=0, seconds=0.0)
    if len(curve) < 2:
        return begin, [begin, *curve][-1]
    return curve[-2 if run.status == RUNNING else 0], curve[-1]
