"""Ask runs to yield: an urgent run finds no free worker, and their owners allow it."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..runs.lifecycle import change
from ..runs.log import note
from ..schedule.fit import ASKING, fits
from ..schedule.order import places
from ..schedule.quota import exhausted
from ..schedule.take import idle
from ..services.services import Services
from ..tables import QUEUED, RUNNING, URGENT, Run, Worker
from ..workers import registry


def make_room(services: Services) -> list[UUID]:
    """Ask a run to yield for each urgent one that waits; return those asked.

    It stops between blocks with a checkpoint and returns to the queue.
    """
    urgent = (Run.status == QUEUED, Run.priority == URGENT, Run.worker.is_(None))
    with services.sessions.read() as session:
        if session.execute(select(Run.id).where(*urgent).limit(1)).one_or_none() is None:
            return []
    with services.sessions.write.begin() as session:
        alive = registry.live(session, services.settings.lease)
        free, moment = idle(session, alive), now(session)
        over, order = exhausted(session), places(session)
        queued = select(*ASKING).join(order, order.c.id == Run.id).where(*urgent)
        waiting = [
            run
            for run in session.execute(queued.order_by(order.c.place))
            if run.owner not in over and not any(fits(run, worker, moment) for worker in free)
        ]
        asked = select(func.count()).where(
            Run.status == RUNNING, Run.requested_state.is_not(None)
        )
        unserved = waiting[session.execute(asked).scalar_one() :]
        return [
            run.id for one in unserved if (run := _ask_one(session, one, alive)) is not None
        ]


def _ask_one(session: Session, urgent: Any, alive: Sequence[Worker]) -> Run | None:
    """Ask the run that started last among those that may yield and whose worker fits."""
    moment = now(session)
    able = [worker.name for worker in alive if fits(urgent, worker, moment)]
    yielding = select(Run).where(
        Run.status == RUNNING,
        Run.may_yield,
        Run.priority != URGENT,
        Run.requested_state.is_(None),
        Run.worker.in_(able),
    )
    run = session.scalars(yielding.order_by(Run.started_at.desc(), Run.id)).first()
    if run is None:
        return None
    free = (Run.status == RUNNING, Run.requested_state.is_(None))
    asked = change(session, run.id, *free, requested_state=QUEUED, requested_at=clock())
    if asked is not None:
        note(session, asked, f"Yields its worker to the urgent run {urgent.id}.")
    return asked
