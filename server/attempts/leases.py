"""Leases: renew them, and take runs back from jobs that ended."""

from typing import Literal
from uuid import UUID

from ..core.database import Sessions, clock
from ..queue.order import requeue
from ..runs.announce import announce
from ..runs.lifecycle import change, hand_back, release
from ..services.services import Services
from ..tables import QUEUED, RUNNING, Run

Lease = Literal["held", "waiting", "over", "lost"]


def heartbeat(sessions: Sessions, run_id: UUID, worker: str) -> Lease:
    """Renew a worker's lease on a run, and return the lease's state.

    `waiting`: not claimed yet. `over`: nobody computes it any more, the job is about to end.
    `lost`: another worker has it, so the job has to be killed.
    """
    with sessions.write.begin() as session:
        mine = (Run.status == RUNNING, Run.worker == worker)
        if change(session, run_id, *mine, heartbeat_at=clock()):
            return "held"
        run = session.get(Run, run_id)
        if run and run.status == RUNNING:
            return "lost"
        return "waiting" if run and run.status == QUEUED else "over"


def job_ended(services: Services, run_id: UUID, worker: str, error: str | None = None) -> None:
    """Take a run back from a job that died, or without an `error` was killed by its worker."""
    mine = Run.worker == worker
    with services.sessions.write.begin() as session:
        if error:
            run = release(session, run_id, mine, error=error)
        else:
            run = hand_back(session, run_id, mine)
    if run:
        announce(services, run_id)
    requeue(services.sessions, services.jobs, run_id)
