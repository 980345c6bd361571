"""queued → running → finished | failed | cancelled, with paused between: who may do what.

Every change is one guarded UPDATE, so that of two that come at once only one happens.
"""

import logging
from typing import Any, NoReturn
from uuid import UUID

from sqlalchemy import case, func, or_, update
from sqlalchemy.orm import Session

from ..core.database import ago, clock
from ..core.errors import ProblemError
from ..tables import (
    CANCELLED,
    FAILED,
    OVERRIDE_ALLOWED,
    OVERRIDE_NEEDED,
    PAUSED,
    QUEUED,
    RUNNING,
    Run,
)
from .log import note, note_status

log = logging.getLogger(__name__)

NOT_IN_BIN = Run.deleted_at.is_(None)
"""The condition that a run does not lie in the bin."""

ATTEMPTS = 3
"""So many attempts without a new checkpoint end a run."""


class Conflict(ProblemError):
    """The state of a run does not allow an action."""

    def __init__(self, action: str, run: Run, needed: str):
        requested = f", to be {run.requested_state}" if run.requested_state else ""
        place = " and in the bin" if run.deleted_at else ""
        standing = f"{run.status}{requested}{place}"
        detail = f"to {action} a run it must be {needed}; it is {standing}"
        super().__init__(409, "Conflict", detail)


def change(session: Session, run_id: UUID, *where: Any, **values: Any) -> Run | None:
    """Change a run if it is as `where` says: the changed row, else None."""
    statement = update(Run).where(Run.id == run_id, *where).values(**values).returning(Run)
    options = {"populate_existing": True, "synchronize_session": False}
    return session.scalars(statement, execution_options=options).one_or_none()


def pause(session: Session, run: Run) -> Run:
    """At once where it waits; where it runs, its worker is asked to."""
    changed = (
        change(session, run.id, NOT_IN_BIN, Run.status == QUEUED, status=PAUSED)
        or change(
            session,
            run.id,
            Run.status == RUNNING,
            or_(Run.requested_state.is_(None), Run.requested_state == PAUSED),
            requested_state=PAUSED,
            requested_at=clock(),
        )
        or refuse(session, "pause", run, "queued or running, not asked to cancel")
    )
    note(session, changed, "Paused." if changed.status == PAUSED else "Asked to pause.")
    return changed


def cancel(session: Session, run: Run) -> Run:
    """At once where it waits or is paused; where it runs, its worker is asked to."""
    changed = (
        change(
            session,
            run.id,
            NOT_IN_BIN,
            Run.status.in_((QUEUED, PAUSED)),
            status=CANCELLED,
            finished_at=clock(),
        )
        or change(
            session,
            run.id,
            Run.status == RUNNING,
            requested_state=CANCELLED,
            requested_at=case(
                (Run.requested_state == CANCELLED, Run.requested_at), else_=clock()
            ),
        )
        or refuse(session, "cancel", run, "queued, running or paused")
    )
    note(session, changed, "Cancelled." if changed.status == CANCELLED else "Asked to cancel.")
    return changed


def resume(session: Session, run: Run) -> Run:
    """Back into the queue, its attempts counted anew."""
    # Whoever resumes a run that waits for leave to change its kind of device gives it.
    leave = case(
        (Run.device_override == OVERRIDE_NEEDED, OVERRIDE_ALLOWED), else_=Run.device_override
    )
    values = {"status": QUEUED, "attempts_without_checkpoint": 0, "device_override": leave}
    values |= {"queued_at": clock()}
    waited = run.device_override == OVERRIDE_NEEDED
    changed = change(session, run.id, NOT_IN_BIN, Run.status == PAUSED, **values) or refuse(
        session, "resume", run, "paused"
    )
    leave = " Another kind of device is allowed." if waited else ""
    note(session, changed, f"Resumed: queued again.{leave}")
    return changed


def refuse(session: Session, action: str, run: Run, needed: str) -> NoReturn:
    """Raise `Conflict`, which says how the run stands now."""
    current = session.get_one(Run, run.id, populate_existing=True)
    raise Conflict(action, current, needed)


def release(session: Session, run_id: UUID, *where: Any, error: str) -> Run | None:
    """Take a running run from an attempt that ended badly, and do what was wished meanwhile.

    It waits for another attempt, unless it is paused, cancelled, or had its last chance.
    """
    run = yield_up(session, run_id, *where, error=error)
    if run is None:
        return None
    note(session, run, f"Attempt {run.attempt} ended badly: {error}", "error")
    if run.status == QUEUED and run.attempts_without_checkpoint >= ATTEMPTS:
        lost = f"{ATTEMPTS} attempts without a new checkpoint"
        text = f"{lost}; the last one: {error}"
        run = change(session, run_id, status=FAILED, finished_at=clock(), error=text)
        assert run is not None
        note(session, run, f"Failed: {lost}.", "error")
    else:
        note_status(session, run)
    return run


def yield_up(session: Session, run_id: UUID, *where: Any, **values: Any) -> Run | None:
    """A running run without its worker: queued again, unless paused or cancelled meanwhile."""
    status = func.coalesce(Run.requested_state, QUEUED)
    values |= {"requested_state": None, "requested_at": None, "worker": None, "status": status}
    values |= {"queued_at": clock()}
    over = case((Run.requested_state == CANCELLED, clock()), else_=None)
    return change(session, run_id, Run.status == RUNNING, *where, finished_at=over, **values)


def hand_back(session: Session, run_id: UUID, *where: Any) -> Run | None:
    """A running run given up in good order: its attempt is not one of the three chances."""
    strikes = Run.attempts_without_checkpoint
    kept = case((strikes > 0, strikes - 1), else_=0)
    run = yield_up(session, run_id, *where, attempts_without_checkpoint=kept)
    if run:
        note(session, run, f"Worker stopped after generation {run.generation}.")
        note_status(session, run)
    return run


def lost(session: Session, lease: float) -> Any:
    """The condition that nobody has spoken for a run as long as a lease."""
    return or_(Run.heartbeat_at.is_(None), Run.heartbeat_at < ago(session, lease))
