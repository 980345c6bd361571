"""Lifecycle of a run: the allowed changes between its states.

The states are queued → running → finished | failed | cancelled, and paused. Each change is one
guarded UPDATE, so that only one of two concurrent changes happens. A change that ends a run, or
pauses it with a warning, also adds a notification.
"""

import logging
from collections.abc import Mapping
from typing import Any, Literal, NoReturn
from uuid import UUID

from sqlalchemy import case, func, or_, update
from sqlalchemy.orm import Session

from ..core.database import clock
from ..core.errors import ProblemError
from ..notifications import outbox
from ..tables import CANCELLED, FAILED, PAUSED, QUEUED, RUNNING, TERMINAL, Run
from ..workers import totals
from .log import note, note_status

log = logging.getLogger(__name__)

NOT_IN_BIN = Run.deleted_at.is_(None)

Reason = Literal["error", "process", "silence"]
"""Why an attempt failed: an exception, a process that died, or a worker that is silent."""
MAX_ATTEMPTS = 3
"""Number of attempts without a new checkpoint after which a run fails."""


class Conflict(ProblemError):
    """The state of a run does not allow an action."""

    def __init__(self, action: str, run: Run, needed: str):
        requested = f", to be {run.requested_state}" if run.requested_state else ""
        place = " and in the bin" if run.deleted_at else ""
        state = f"{run.status}{requested}{place}"
        detail = f"to {action} a run it must be {needed}; it is {state}"
        super().__init__(409, "Conflict", detail)


def change(session: Session, run_id: UUID, *where: Any, **values: Any) -> Run | None:
    """Change a run if it satisfies `where`; return the changed row, else None."""
    statement = update(Run).where(Run.id == run_id, *where).values(**values).returning(Run)
    options = {"populate_existing": True, "synchronize_session": False}
    run = session.scalars(statement, execution_options=options).one_or_none()
    if run and "status" in values and (run.status in TERMINAL or _needs_person(run, values)):
        outbox.add(session, run)
    return run


def _needs_person(run: Run, values: Mapping[str, Any]) -> bool:
    """Return whether a change pauses a run until a person acts; its warning says why."""
    return run.status == PAUSED and "warning" in values


def pause(session: Session, run: Run) -> Run:
    """Pause a queued run at once; request it from the worker of a running one."""
    changed = (
        change(session, run.id, NOT_IN_BIN, Run.status == QUEUED, status=PAUSED, worker=None)
        or change(
            session,
            run.id,
            Run.status == RUNNING,
            or_(Run.requested_state.is_(None), Run.requested_state != CANCELLED),
            requested_state=PAUSED,
            requested_at=clock(),
        )
        or refuse(session, "pause", run, "queued or running, without a requested cancellation")
    )
    note(session, changed, "Paused." if changed.status == PAUSED else "Pause requested.")
    return changed


def cancel(session: Session, run: Run) -> Run:
    """Cancel a queued or paused run at once; request it from the worker of a running one."""
    changed = (
        change(
            session,
            run.id,
            NOT_IN_BIN,
            Run.status.in_((QUEUED, PAUSED)),
            status=CANCELLED,
            worker=None,
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
    text = "Cancelled." if changed.status == CANCELLED else "Cancellation requested."
    note(session, changed, text)
    return changed


def resume(session: Session, run: Run) -> Run:
    """Queue a paused run again, and count its attempts from 0."""
    values = {"status": QUEUED, "attempts_without_checkpoint": 0}
    values |= {"queued_at": clock(), "interrupted": False}
    changed = change(session, run.id, NOT_IN_BIN, Run.status == PAUSED, **values)
    changed = changed or refuse(session, "resume", run, "paused")
    note(session, changed, "Resumed: queued again.")
    return changed


def refuse(session: Session, action: str, run: Run, needed: str) -> NoReturn:
    """Raise `Conflict` with the current state of the run."""
    current = session.get_one(Run, run.id, populate_existing=True)
    raise Conflict(action, current, needed)


def fail_attempt(
    session: Session, run_id: UUID, *where: Any, error: str, reason: Reason
) -> Run | None:
    """End an attempt that failed, count it, and queue the run again.

    If requested, pause or cancel it instead; fail it after `MAX_ATTEMPTS` attempts.
    """
    run = end_attempt(session, run_id, *where, error=error, avoided_worker=Run.worker)
    if run is None:
        return None
    note(session, run, f"Attempt {run.attempt} failed: {error}", "error")
    return _fail_after_last_attempt(session, run, error, reason)


def fail_unclaimed(session: Session, run_id: UUID, *where: Any, error: str) -> Run | None:
    """Count the death of a process that had taken a run and not claimed it yet."""
    values = {"attempts_without_checkpoint": Run.attempts_without_checkpoint + 1}
    values |= {"interrupted": True, "error": error}
    values |= {"worker": None, "avoided_worker": Run.worker}
    run = change(session, run_id, Run.status == QUEUED, *where, **values)
    if run is None:
        return None
    note(session, run, f"An attempt failed before it began: {error}", "error")
    return _fail_after_last_attempt(session, run, error, "process")


def _fail_after_last_attempt(session: Session, run: Run, error: str, reason: Reason) -> Run:
    """Fail a queued run that had all its attempts; count the failure of the last one."""
    worker = run.avoided_worker
    if run.status == QUEUED and run.attempts_without_checkpoint >= MAX_ATTEMPTS:
        limit = f"{MAX_ATTEMPTS} attempts without a new checkpoint"
        text = f"{limit}; the last one: {error}"
        failed = change(session, run.id, status=FAILED, finished_at=clock(), error=text)
        assert failed is not None
        note(session, failed, f"Failed: {limit}.", "error")
        run = failed
    else:
        note_status(session, run)
    totals.count(session, worker, totals.FAILURES[reason])
    return run


def end_attempt(session: Session, run_id: UUID, *where: Any, **values: Any) -> Run | None:
    """Queue a running run again without a worker; if requested, pause or cancel it instead.

    In the queue it goes before all others, for it had its turn, unless it yields to another.
    """
    status = func.coalesce(Run.requested_state, QUEUED)
    values |= {"requested_state": None, "requested_at": None, "worker": None, "status": status}
    values |= {"interrupted": Run.requested_state.is_(None), "released_at": clock()}
    over = case((Run.requested_state == CANCELLED, clock()), else_=None)
    return change(session, run_id, Run.status == RUNNING, *where, finished_at=over, **values)


def release(session: Session, run_id: UUID, *where: Any) -> Run | None:
    """Take a run back from a worker that has not claimed it."""
    taken = (Run.status == QUEUED, Run.worker.is_not(None))
    return change(session, run_id, *taken, *where, worker=None)


def stop_attempt(session: Session, run_id: UUID, *where: Any) -> Run | None:
    """End an attempt that did not fail; it does not count towards `MAX_ATTEMPTS`."""
    counted = Run.attempts_without_checkpoint
    earlier = case((counted > 0, counted - 1), else_=0)
    run = end_attempt(session, run_id, *where, attempts_without_checkpoint=earlier)
    if run:
        note(session, run, f"Worker stopped after generation {run.generation}.")
        note_status(session, run)
    return run
