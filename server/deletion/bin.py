"""The bin: deleted runs, until they are restored or purged."""

from datetime import timedelta

from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..runs.lifecycle import NOT_IN_BIN, change, refuse
from ..runs.log import note
from ..tables import PAUSED, TERMINAL, Run


def put(session: Session, run: Run, seconds: float) -> Run:
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
