"""How sweeps stand, and what is asked of all their runs at once."""

import logging
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from datetime import datetime
from itertools import product
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, and_, or_, select
from sqlalchemy.orm import Session

from ..auth import tokens
from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..runs.announce import announce as announce_runs
from ..runs.lifecycle import KEPT, Conflict
from ..runs.overview import progress
from ..services.services import Services
from ..tables import STATUSES, Run, Sweep
from .schemas import CaseRead, SkippedRun, SweepPage, SweepRead

AT_ONCE = 50
"""Runs that are changed in one transaction: nobody is held up for long."""

log = logging.getLogger(__name__)


def read_sweeps(session: Session, sweeps: Sequence[Sweep]) -> list[SweepRead]:
    """With their runs, all in one query."""
    of_sweeps: dict[UUID, list[Any]] = defaultdict(list)
    names = ("id", "sweep", "sweep_index", "status", "generation", "generations", "deleted_at")
    columns = [getattr(Run, name) for name in names]
    mine = Run.sweep.in_([sweep.id for sweep in sweeps])
    for row in session.execute(
        select(*columns).where(mine).order_by(Run.sweep, Run.sweep_index)
    ):
        of_sweeps[row.sweep].append(row)
    named = tokens.names(session, (sweep.owner for sweep in sweeps))
    return [_read(one, of_sweeps[one.id], named.get(one.owner)) for one in sweeps]


def page(session: Session, cursor: str | None, limit: int, deleted: bool) -> SweepPage:
    """Newest first from a place on: those that have runs, or those whose runs are deleted."""
    kept = select(Run.id).where(Run.sweep == Sweep.id, KEPT).exists()
    listed = select(Sweep).where(~kept if deleted else kept)
    if cursor is not None:
        listed = listed.where(_after(cursor))
    ordered = listed.order_by(Sweep.created_at.desc(), Sweep.id.desc())
    found = session.scalars(ordered.limit(limit + 1)).all()
    more = len(found) > limit
    items = read_sweeps(session, found[:limit])
    return SweepPage(items=items, next=_place(found[limit - 1]) if more else None)


def _place(sweep: Sweep) -> str:
    """In an address as it is: there, a plus would be a space."""
    return f"{sweep.created_at:%Y-%m-%dT%H:%M:%S.%fZ}~{sweep.id}"


def _after(cursor: str) -> ColumnElement[bool]:
    moment, _, last = cursor.partition("~")
    try:
        created, identity = datetime.fromisoformat(moment).astimezone(), UUID(last)
    except (ValueError, OverflowError):
        needed = "the `next` of an earlier answer"
        detail = f"`cursor` must be {needed}; got {cursor!r:.80}."
        error = FieldError(field="cursor", message=detail, needed=needed, got=cursor)
        raise ProblemError(422, "Invalid input", detail, [error]) from None
    same = and_(Sweep.created_at == created, Sweep.id < identity)
    return or_(Sweep.created_at < created, same)


def read_sweep(session: Session, sweep: Sweep) -> SweepRead:
    return read_sweeps(session, [sweep])[0]


def _read(sweep: Sweep, all_runs: Sequence[Any], owner: str | None) -> SweepRead:
    runs = [run for run in all_runs if run.deleted_at is None]
    cases = [CaseRead(values=values, runs=[]) for values in combinations(sweep.grid)]
    for run in runs:
        cases[run.sweep_index % len(cases)].runs.append(run.id)
    counted = Counter(run.status for run in runs)
    shares = [progress(run) for run in runs]
    names = ("id", "name", "experiment", "spec", "seeds", "grid", "created_at")
    return SweepRead(
        **{name: getattr(sweep, name) for name in names},
        owner=owner,
        cases=cases,
        total=len(runs),
        deleted=len(all_runs) - len(runs),
        status_counts={status: counted[status] for status in STATUSES if counted[status]},
        progress=sum(shares) / len(shares) if shares else 1.0,
    )


def combinations(grid: dict[str, list[Any]]) -> list[dict[str, Any]]:
    """The values of each case, the last field fastest."""
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]


def steer(
    services: Services,
    sweep_id: UUID,
    change: Callable[[Session, Run], Run],
    among: ColumnElement[bool] = KEPT,
) -> tuple[list[UUID], list[SkippedRun]]:
    """Change each run by itself: those that did, and those that could not."""
    with services.sessions.read() as session:
        mine = select(Run.id).where(Run.sweep == sweep_id, among).order_by(Run.sweep_index)
        ids = list(session.scalars(mine))
    changed: list[UUID] = []
    skipped: list[SkippedRun] = []
    for some in several(ids):
        with services.sessions.write.begin() as session:
            # In one order, so that two who ask cannot wait for each other.
            runs = select(Run).where(Run.id.in_(some)).order_by(Run.sweep_index)
            for run in session.scalars(runs).all():
                try:
                    changed.append(change(session, run).id)
                except Conflict as refusal:
                    skipped.append(_skipped(session, run, refusal))
        announce_runs(services, *(run_id for run_id in some if run_id in changed))
    announce(services, sweep_id)
    return changed, skipped


def _skipped(session: Session, run: Run, refusal: Conflict) -> SkippedRun:
    session.refresh(run)
    return SkippedRun.model_validate(
        {"run": run.id, "status": run.status, "reason": f"{refusal}."}
    )


def several(ids: Sequence[UUID]) -> list[Sequence[UUID]]:
    return [ids[first : first + AT_ONCE] for first in range(0, len(ids), AT_ONCE)]


def announce(services: Services, sweep_id: UUID) -> None:
    """Tell everybody that a sweep began or changed; how it stands they ask themselves."""
    services.events.publish("sweep", sweep_id, {"sweep": str(sweep_id)})
