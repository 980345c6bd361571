"""What workers say about themselves, and that a run is still in good hands."""

from typing import Literal
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from .db import Sessions, ago, clock
from .lifecycle import change
from .models import QUEUED, RUNNING, Run, Worker

Lease = Literal["held", "waiting", "over", "lost"]


def report(
    sessions: Sessions,
    name: str,
    device: str,
    memory_bytes: int,
    status: Literal["idle", "busy"],
    run_id: UUID | None = None,
) -> None:
    """Say that a worker is alive."""
    with sessions.write.begin() as session:
        row = Worker(
            name=name, device=device, memory_bytes=memory_bytes, status=status, run_id=run_id
        )
        session.merge(row).heartbeat_at = clock()


def retire(sessions: Sessions, name: str) -> None:
    """Say that a worker has ended."""
    with sessions.write.begin() as session:
        session.execute(delete(Worker).where(Worker.name == name))


def live(session: Session, lease: float) -> list[Worker]:
    """Workers that were heard of within a lease, by name."""
    alive = Worker.heartbeat_at >= ago(session, lease)
    return list(session.scalars(select(Worker).where(alive).order_by(Worker.name)))


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
