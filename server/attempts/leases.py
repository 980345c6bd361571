"""Leases: renew one, test whether it has expired, and end it with its job."""

from typing import Any, Literal
from uuid import UUID

from sqlalchemy import or_
from sqlalchemy.orm import Session

from ..core.database import Sessions, ago, clock
from ..queue.order import requeue
from ..runs.announce import announce
from ..runs.lifecycle import change, fail_attempt, stop_attempt
from ..services.services import Services
from ..tables import QUEUED, RUNNING, Run

LeaseState = Literal["held", "waiting", "over", "lost"]


def heartbeat(sessions: Sessions, run_id: UUID, worker: str) -> LeaseState:
    """Renew a worker's lease on a run, and return the lease's state.

    `waiting`: no worker has claimed the run yet. `over`: no attempt is active any more.
    `lost`: another worker has the run, so the job must be killed.
    """
    with sessions.write.begin() as session:
        mine = (Run.status == RUNNING, Run.worker == worker)
        if change(session, run_id, *mine, heartbeat_at=clock()):
            return "held"
        run = session.get(Run, run_id)
        if run and run.status == RUNNING:
            return "lost"
        return "waiting" if run and run.status == QUEUED else "over"


def lease_expired(session: Session, lease: float) -> Any:
    """Return the condition that a run has had no heartbeat for as long as a lease."""
    return or_(Run.heartbeat_at.is_(None), Run.heartbeat_at < ago(session, lease))


def end_job(services: Services, run_id: UUID, worker: str, error: str | None = None) -> None:
    """End the attempt of a dead job. Without an `error`, its worker killed it on purpose."""
    mine = Run.worker == worker
    with services.sessions.write.begin() as session:
        if error:
            run = fail_attempt(session, run_id, mine, error=error)
        else:
            run = stop_attempt(session, run_id, mine)
    if run:
        announce(services, run_id)
    requeue(services.sessions, services.jobs, run_id)
