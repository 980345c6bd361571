"""The queue: runs that wait for a worker."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from ..auth.authorize import MAY_READ
from ..services.deps import ServicesDep, SessionDep
from ..tables import QUEUED, Run
from ..workers.brief import brief
from . import position
from .schemas import QueuedRun, QueueRead

router = APIRouter(prefix="/queue", tags=["workers"])


@router.get("", dependencies=[MAY_READ])
def read_queue(
    services: ServicesDep,
    session: SessionDep,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> QueueRead:
    """How many runs wait, and the first of them, in order, each with the reason."""
    line = position.line(services, session)
    first = line.runs[:limit]
    waits = select(Run).where(Run.id.in_(first), Run.status == QUEUED)
    found = {run.id: run for run in session.scalars(waits)}
    runs = [found[run_id] for run_id in first if run_id in found]
    reasons = position.reasons_in(line, runs)
    items = [
        QueuedRun(
            **brief(run).model_dump(),
            waiting_reason=reasons[run.id],
            queued_at=run.queued_at,
            memory_bytes=position.needed_bytes(run),
        )
        for run in runs
    ]
    return QueueRead(total=len(line.runs), items=items)
