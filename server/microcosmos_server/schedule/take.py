"""Give a worker its next run, within the quotas of owners."""

from collections.abc import Collection
from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import func, or_, select, text, update
from sqlalchemy.orm import Session

from ..auth.device_use import device_seconds
from ..core.database import clock, now
from ..core.errors import TooMany
from ..services.services import Services
from ..tables import QUEUED, RUNNING, USE_DAYS, Run, Token, Worker
from ..workers import registry
from .fit import NEEDS, fits
from .order import places


def refuse_too_many(session: Session, owner: UUID | None, added: int) -> None:
    """Raise `DomainError` if an owner would have more queued runs than the quota allows.

    Call it before a run is locked: other requests of the owner wait until this one ends.
    """
    token = session.get(Token, owner) if owner else None
    if token is None or token.max_queued is None:
        return
    # Two requests must not fill the last place. SQLite has one writer anyway.
    session.execute(select(Token.id).where(Token.id == owner).with_for_update())
    mine = select(func.count()).where(Run.owner == owner, Run.status == QUEUED)
    queued = session.execute(mine).scalar_one()
    if queued + added > token.max_queued:
        detail = (
            f"`{token.name}` may have {token.max_queued:,} queued runs; it has {queued:,}, and "
            f"this request adds {added:,}."
        )
        raise TooMany(detail, title="Too many queued runs")


def places_left(session: Session) -> dict[UUID | None, int]:
    """Return how many more runs of each owner with a limit may have a worker."""
    limits = select(Token.id, Token.max_running)
    with_worker = or_(Run.status == RUNNING, (Run.status == QUEUED) & Run.worker.is_not(None))
    counts = select(Run.owner, func.count()).where(with_worker).group_by(Run.owner)
    running = {owner: number for owner, number in session.execute(counts)}
    return {
        owner: most - running.get(owner, 0)
        for owner, most in session.execute(limits)
        if most is not None
    }


def exhausted(session: Session) -> dict[UUID | None, str]:
    """Return a sentence about the exhausted quota of each owner whose runs must wait."""
    limited = or_(Token.max_running.is_not(None), Token.device_hours.is_not(None))
    tokens = session.scalars(select(Token).where(limited)).all()
    if not tokens:
        return {}
    left, used = places_left(session), device_seconds(session, USE_DAYS)
    found: dict[UUID | None, str] = {}
    for token in tokens:
        hours = used.get(token.id, 0.0) / 3600
        if token.max_running is not None and left.get(token.id, 0) <= 0:
            runs = "1 run" if token.max_running == 1 else f"{token.max_running} runs"
            found[token.id] = f"Waits: `{token.name}` may compute {runs} at a time."
        elif token.device_hours is not None and hours >= token.device_hours:
            found[token.id] = (
                f"Waits: `{token.name}` has used {hours:.1f} of its {token.device_hours:g} "
                f"device hours in {USE_DAYS} days."
            )
    return found


WAITING = (Run.status == QUEUED, Run.worker.is_(None))
"""Conditions of runs that a worker may take."""
LOCK = 0x6D696372  # "micr": PostgreSQL's advisory locks are numbers.


def take(services: Services, name: str) -> UUID | None:
    """Give a worker the next run that it can carry out; None if there is none.

    The run stays queued until the worker's process claims it. The worker keeps the run as long
    as it sends heartbeats.
    """
    lease = services.settings.lease
    with services.sessions.read() as session:
        if _next(session, name, lease) is None:  # Idle workers ask often: they lock nothing.
            return None
    with services.sessions.write.begin() as session:
        _one_at_a_time(session)
        found = _next(session, name, lease)
        # With the condition again: since the read it may have been paused or cancelled.
        taken = update(Run).where(Run.id == found, *WAITING)
        done = session.execute(
            taken.values(worker=name, heartbeat_at=clock()).returning(Run.id)
        )
        return done.scalar_one_or_none()


def _one_at_a_time(session: Session) -> None:
    """Wait for other takers: two of them must not fill the last place of a quota."""
    if session.get_bind().dialect.name == "postgresql":  # SQLite has one writer anyway.
        session.execute(text(f"SELECT pg_advisory_xact_lock({LOCK})"))


def _next(session: Session, name: str, lease: float) -> UUID | None:
    worker = session.get(Worker, name)
    if worker is None or worker.problem is not None:
        return None
    if session.execute(select(Run.id).where(*WAITING).limit(1)).one_or_none() is None:
        return None
    over, moment, order = exhausted(session), now(session), places(session)
    others = [
        one for one in idle(session, registry.live(session, lease)) if one.name != worker.name
    ]
    queued = select(*NEEDS).join(order, order.c.id == Run.id).where(*WAITING)
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
