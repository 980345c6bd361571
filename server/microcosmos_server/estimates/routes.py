"""The route of the queue."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from ..auth import tokens
from ..auth.authorize import MAY_READ
from ..core.schemas import Wire
from ..schedule.order import places
from ..services.services import ServicesDep
from ..storage import space
from ..tables import Priority, Run
from ..workers.registry import run_brief
from ..workers.schemas import RunBrief
from . import position


class QueuedRun(RunBrief):
    waiting_reason: str
    queued_at: datetime
    memory_bytes: int | None
    """Needed memory; None if it is unknown."""
    priority: Priority
    owner: str | None
    """Name of the token that created it."""


class QueueRead(Wire):
    total: int
    """All queued runs, also those that a worker is about to start."""
    warning: str | None
    """About a disk of the installation that is almost full."""
    items: list[QueuedRun]
    """The first ones, in the order in which workers take them."""


router = APIRouter(prefix="/queue", tags=["workers"])


@router.get("", dependencies=[MAY_READ])
def read_queue(
    services: ServicesDep,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> QueueRead:
    """Return the number of queued runs, and the first of them with the reasons for waiting."""
    with services.sessions.read() as session:
        queue = position.queue_state(services, session)
        order = places(session)
        first = select(Run, order.c.place).join(order, order.c.id == Run.id)
        rows = session.execute(first.order_by(order.c.place).limit(limit)).all()
        reasons = {run.id: position.reason(run, place, queue) for run, place in rows}
        runs = [run for run, _ in rows]
        names = tokens.owner_names(session, (run.owner for run in runs))
        items = [
            QueuedRun(
                **run_brief(run).model_dump(),
                waiting_reason=reasons[run.id],
                queued_at=run.queued_at,
                memory_bytes=run.memory_bytes,
                priority=run.priority,
                owner=names.get(run.owner),
            )
            for run in runs
        ]
    # Over no session: the store's disk may be slow.
    warning = space.shortage(services.settings, services.artifacts)
    return QueueRead(total=queue.queued, warning=warning, items=items)
