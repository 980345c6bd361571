"""The order of queued runs, and their return to the queue."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Row, select
from sqlalchemy.orm import Session

from ..core.database import Sessions
from ..tables import QUEUED, Run
from .jobs import Jobs

QueuedRun = Row[UUID, UUID | None, list[str] | None]
"""The `id`, `sweep` and `plugin_versions` of a queued run."""


def in_order(session: Session, *where: Any) -> Sequence[QueuedRun]:
    """Return the queued runs in the order in which workers take them: sweeps last."""
    queued = select(Run.id, Run.sweep, Run.plugin_versions).where(Run.status == QUEUED, *where)
    # SQLite's clock counts milliseconds: runs that were resumed together keep their old order.
    ordered = queued.order_by(Run.sweep.is_not(None), Run.queued_at, Run.created_at, Run.id)
    return session.execute(ordered).all()


def requeue(sessions: Sessions, jobs: Jobs, *run_ids: UUID) -> None:
    """Enqueue those of the runs that are queued."""
    with sessions.read() as session:
        found = in_order(session, Run.id.in_(run_ids))
    jobs.enqueue(found)
