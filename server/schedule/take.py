"""Give a worker its next run, and take it back from a worker that does not claim it."""

from collections.abc import Collection
from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import select, text, update
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..services.services import Services
from ..tables import QUEUED, RUNNING, Run, Worker
from ..workers import registry
from .fit import ASKING, fits
from .order import places
from .quota import exhausted

LOCK = 0x6D696372  # "micr": PostgreSQL's advisory locks are numbers.


def take(services: Services, name: str) -> UUID | None:
    """Give a worker the next run that it can carry out; None if there is none.

    The run stays queued until the worker's process claims it, and is the worker's for as long
    as it sends heartbeats.
    """
    lease = services.settings.lease
    with services.sessions.read() as session:
        if _next(session, name, lease) is None:  # Idle workers ask often: they lock nothing.
            return None
    with services.sessions.write.begin() as session:
        _one_at_a_time(session)
        found = _next(session, name, lease)
        if found is not None:
            session.execute(
                update(Run).where(Run.id == found).values(worker=name, heartbeat_at=clock())
            )
        return found


def _one_at_a_time(session: Session) -> None:
    """Wait for other takers: two of them must not fill the last place of a quota."""
    if session.get_bind().dialect.name == "postgresql":  # SQLite has one writer anyway.
        session.execute(text(f"SELECT pg_advisory_xact_lock({LOCK})"))


def _next(session: Session, name: str, lease: float) -> UUID | None:
    waiting = (Run.status == QUEUED, Run.worker.is_(None))
    worker = session.get(Worker, name)
    if worker is None or worker.problem is not None:
        return None
    if session.execute(select(Run.id).where(*waiting).limit(1)).one_or_none() is None:
        return None
    over, moment, order = exhausted(session), now(session), places(session)
    others = [
        one for one in idle(session, registry.live(session, lease)) if one.name != worker.name
    ]
    queued = select(*ASKING).join(order, order.c.id == Run.id).where(*waiting)
    for run in session.execute(queued.order_by(order.c.place)):
        if (
            run.owner not in over
            and fits(run, worker, moment)
            and not _should_avoid(run, worker, others, moment)
        ):
            return run.id
    return None


def _should_avoid(
    run: Any, worker: Worker, others: Collection[Worker], moment: datetime
) -> bool:
    """Return whether the run failed on the worker and a free one can try it instead."""
    return run.avoided_worker == worker.name and any(fits(run, one, moment) for one in others)


def idle(session: Session, alive: Collection[Worker]) -> list[Worker]:
    """Return those of the workers that have no run and no problem."""
    busy = runs_of(session, alive)
    return [one for one in alive if one.name not in busy and one.problem is None]


def runs_of(session: Session, workers: Collection[Worker]) -> dict[str, UUID]:
    """Return the run that a worker has claimed or taken, by the worker's name."""
    theirs = Run.worker.in_([worker.name for worker in workers])
    having = select(Run.worker, Run.id).where(Run.status.in_((RUNNING, QUEUED)), theirs)
    return {str(name): run_id for name, run_id in session.execute(having)}
