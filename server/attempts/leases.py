"""That a run is still in good hands."""

from typing import Literal
from uuid import UUID

from ..core.database import Sessions, clock
from ..runs.lifecycle import change
from ..tables import QUEUED, RUNNING, Run

Lease = Literal["held", "waiting", "over", "lost"]


def heartbeat(sessions: Sessions, run_id: UUID, worker: str) -> Lease:
    """Renew a worker's lease on a run, by its supervisor: how the run stands for it.

    `waiting`: not claimed yet. `over`: nobody computes it any more, the job is about to end.
    `lost`: another worker has it, so the job is to be killed.
    """
    with sessions.write.begin() as session:
        mine = (Run.status == RUNNING, Run.worker == worker)
        if change(session, run_id, *mine, heartbeat_at=clock()):
            return "held"
        run = session.get(Run, run_id)
        if run and run.status == RUNNING:
            return "lost"
        return "waiting" if run and run.status == QUEUED else "over"
