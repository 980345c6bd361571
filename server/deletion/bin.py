"""The bin: runs that nobody sees any more, until they are restored or go for good."""

from datetime import timedelta

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..core.database import clock
from ..runs.lifecycle import KEPT, change, refuse
from ..runs.log import note
from ..tables import PAUSED, TERMINAL, Run


def put(session: Session, run: Run, seconds: float) -> Run:
    """Into the bin for so long; nobody may be at work on it."""
    now = session.execute(select(clock())).scalar_one()
    over = Run.status.in_((*TERMINAL, PAUSED))
    times = {"deleted_at": now, "purge_at": now + timedelta(seconds=seconds)}
    changed = change(session, run.id, KEPT, over, **times)
    if changed is None:
        refuse(session, "delete", run, "finished, failed, cancelled or paused: cancel it first")
    note(session, changed, f"Deleted: in the bin until {times['purge_at']:%Y-%m-%d %H:%M} UTC.")
    return changed


def restore(session: Session, run: Run) -> Run:
    """Out of the bin, as long as nothing of it is gone."""
    in_time = (Run.deleted_at.is_not(None), Run.purge_at > clock())
    changed = change(session, run.id, *in_time, deleted_at=None, purge_at=None)
    if changed is None:
        refuse(session, "restore", run, "in the bin, and its time there not over")
    note(session, changed, "Restored from the bin.")
    return changed
