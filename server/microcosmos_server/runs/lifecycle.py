"""Lifecycle of a run: the allowed changes between its states.

The states are queued → running → finished | failed | cancelled, and paused. Each change is one
guarded UPDATE, so that only one of two concurrent changes happens. A change that ends a run, or
pauses it with a warning, also adds a notification.
"""

import logging
from datetime import timedelta
from typing import Any, Literal, NoReturn
from uuid import UUID

from sqlalchemy import case, func, update
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..core.errors import Conflict
from ..notifications import outbox
from ..schedule.take import refuse_too_many
from ..tables import CANCELLED, FAILED, PAUSED, QUEUED, RUNNING, TERMINAL, Run
from ..workers import totals
from .log import note, note_status

log = logging.getLogger(__name__)

NOT_IN_BIN = Run.deleted_at.is_(None)

Reason = Literal["error", "process", "silence"]
"""The cause of a failure: an exception, a process that died, or a worker that is silent."""
MAX_ATTEMPTS = 3
"""Number of attempts without a new checkpoint after which a run fails."""


class WrongState(Conflict):
    """The state of a run does not allow an action."""

    def __init__(self, action: str, run: Run, needed: str):
        requested = f" (requested: {run.requested_state})" if run.requested_state else ""
        place = " and in the bin" if run.deleted_at else ""
        state = f"{run.status}{requested}{place}"
        detail = f"Cannot {action} this run: it is {state}; it must be {needed}"
        super().__init__(detail)


def change(session: Session, run_id: UUID, *where: Any, **values: Any) -> Run | None:
    """Change a run if it satisfies `where`; return the changed row, else None."""
    statement = update(Run).where(Run.id == run_id, *where).values(**values).returning(Run)
    # The session may hold the row as it was before another transaction changed it.
    options = {"populate_existing": True, "synchronize_session": False}
    run = session.scalars(statement, execution_options=options).one_or_none()
    # A change that pauses a run with a warning makes it wait for a person.
    needs_person = run and run.status == PAUSED and values.get("warning") is not None
    if run and "status" in values and (run.status in TERMINAL or needs_person):
        outbox.add(session, run)
    return run


def pause(session: Session, run: Run) -> Run:
    """Pause a queued run at once; request it from the worker of a running one.

    An old warning goes: a paused run with one waits for a person.
    """
    now_paused = {"status": PAUSED, "worker": None, "warning": None}
    requested = {"requested_state": PAUSED, "requested_at": clock(), "warning": None}
    running = (Run.status == RUNNING, Run.requested_state.is_distinct_from(CANCELLED))
    changed = (
        change(session, run.id, NOT_IN_BIN, Run.status == QUEUED, **now_paused)
        or change(session, run.id, *running, **requested)
        or refuse(session, "pause", run, "queued or running, without a requested cancellation")
    )
    note(session, changed, "Paused." if changed.status == PAUSED else "Pause requested.")
    return changed


def cancel(session: Session, run: Run) -> Run:
    """Cancel a queued or paused run at once; request it from the worker of a running one."""
    again = Run.requested_state == CANCELLED
    changed = (
        change(
            session,
            run.id,
            NOT_IN_BIN,
            Run.status.in_((QUEUED, PAUSED)),
            status=CANCELLED,
            cancelled_from=Run.status,
            worker=None,
            finished_at=clock(),
        )
        or change(
            session,
            run.id,
            Run.status == RUNNING,
            requested_state=CANCELLED,
            cancelled_from=case(
                (again, Run.cancelled_from), (Run.requested_state == PAUSED, PAUSED), else_=None
            ),
            requested_at=case((again, Run.requested_at), else_=clock()),
        )
        or refuse(session, "cancel", run, "queued, running or paused")
    )
    text = "Cancelled." if changed.status == CANCELLED else "Cancellation requested."
    note(session, changed, text)
    return changed


def uncancel(session: Session, run: Run) -> Run:
    """Take a cancellation back: queue or pause the run as it was, or let it go on."""
    if run.status == CANCELLED and run.cancelled_from != PAUSED:
        refuse_too_many(session, run.owner, 1)
    values = {"status": func.coalesce(Run.cancelled_from, QUEUED), "finished_at": None}
    values |= {"worker": None}  # The one that it had before.
    values |= {"released_at": clock()}  # A cancelled run does not wait for its kind of device.
    # A run that a worker had does not wait behind all others again.
    values |= {"interrupted": Run.cancelled_from.is_(None), "attempts_without_checkpoint": 0}
    asked = (Run.status == RUNNING, Run.requested_state == CANCELLED)
    earlier = {"requested_state": Run.cancelled_from}
    earlier |= {"requested_at": case((Run.cancelled_from.is_not(None), clock()), else_=None)}
    changed = (
        change(session, run.id, NOT_IN_BIN, Run.status == CANCELLED, **values)
        or change(session, run.id, *asked, **earlier)
        or refuse(session, "uncancel", run, "cancelled, or about to be")
    )
    outbox.withdraw(session, run.id)
    note(session, changed, "The cancellation was taken back.")
    return changed


def resume(session: Session, run: Run) -> Run:
    """Queue a paused run again, and count its attempts from 0."""
    if run.status == PAUSED:
        refuse_too_many(session, run.owner, 1)
    values = {"status": QUEUED, "attempts_without_checkpoint": 0, "warning": None}
    values |= {"queued_at": clock(), "interrupted": False}
    changed = change(session, run.id, NOT_IN_BIN, Run.status == PAUSED, **values)
    changed = changed or refuse(session, "resume", run, "paused")
    note(session, changed, "Resumed: queued again.")
    return changed


def delete(session: Session, run: Run, seconds: float) -> Run:
    """Move a run that nobody computes to the bin for some seconds."""
    deleted_at = now(session)
    over = Run.status.in_((*TERMINAL, PAUSED))
    times = {"deleted_at": deleted_at, "purge_at": deleted_at + timedelta(seconds=seconds)}
    changed = change(session, run.id, NOT_IN_BIN, over, **times)
    if changed is None:
        refuse(session, "delete", run, "finished, failed, cancelled or paused: cancel it first")
    note(session, changed, f"Deleted: in the bin until {times['purge_at']:%Y-%m-%d %H:%M} UTC.")
    return changed


def restore(session: Session, run: Run) -> Run:
    """Restore a run from the bin before it is purged."""
    in_time = (Run.deleted_at.is_not(None), Run.purge_at > clock())
    changed = change(session, run.id, *in_time, deleted_at=None, purge_at=None)
    if changed is None:
        refuse(session, "restore", run, "in the bin, before it is purged")
    note(session, changed, "Restored from the bin.")
    return changed


def refuse(session: Session, action: str, run: Run, needed: str) -> NoReturn:
    """Raise `WrongState` with the current state of the run."""
    current = session.get_one(Run, run.id, populate_existing=True)
    raise WrongState(action, current, needed)


def fail_attempt(
    session: Session,
    run_id: UUID,
    *where: Any,
    error: str,
    details: str | None = None,
    reason: Reason,
) -> Run | None:
    """End an attempt that failed, count it, and queue the run again.

    If requested, pause or cancel it instead; fail it after `MAX_ATTEMPTS` attempts. `details`
    are the traceback, or the last lines that the process wrote.
    """
    values = {"error": error, "error_details": details, "avoided_worker": Run.worker}
    run = end_attempt(session, run_id, *where, **values)
    if run is None:
        return None
    note(session, run, f"Attempt {run.attempt} failed: {error}", "error", details=details)
    return _fail_after_last_attempt(session, run, error, reason)


def fail_unclaimed(
    session: Session, run_id: UUID, *where: Any, error: str, details: str | None = None
) -> Run | None:
    """Count the death of a process that had taken a run and not claimed it yet."""
    values = {"attempts_without_checkpoint": Run.attempts_without_checkpoint + 1}
    values |= {"interrupted": True, "error": error, "error_details": details}
    values |= {"worker": None, "avoided_worker": Run.worker}
    run = change(session, run_id, Run.status == QUEUED, *where, **values)
    if run is None:
        return None
    text = f"An attempt failed before it began: {error}"
    note(session, run, text, "error", details=details)
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

    In the queue the run goes before all others, since it had its turn, unless it yields.
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
