"""Preemption: ask runs to yield their workers to urgent runs, if their owners allow that."""

import math
from collections import defaultdict
from collections.abc import Collection
from typing import NamedTuple
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..runs.lifecycle import change
from ..runs.log import note
from ..schedule.fit import NEEDS, fits
from ..schedule.order import places
from ..schedule.take import WAITING, exhausted, idle, places_left
from ..services.services import Services
from ..tables import QUEUED, RUNNING, URGENT, Run, Worker
from ..workers import registry


class Host(NamedTuple):
    """A worker that an urgent run can have."""

    worker: Worker
    yielding: UUID | None
    """The run that has to yield it; None if the worker is free or about to be."""


def make_room(services: Services) -> list[UUID]:
    """Ask a run to yield for each urgent run that finds no other worker; return those asked.

    A run that yields stops between blocks with a checkpoint and returns to the queue.
    """
    urgent = (*WAITING, Run.priority == URGENT)
    with services.sessions.read() as session:
        if session.execute(select(Run.id).where(*urgent).limit(1)).one_or_none() is None:
            return []
    with services.sessions.write.begin() as session:
        hosts = _hosts(session, registry.live(session, services.settings.lease))
        over, order, moment = exhausted(session), places(session), now(session)
        left = defaultdict[UUID | None, float](lambda: math.inf, places_left(session))
        queued = select(*NEEDS).join(order, order.c.id == Run.id).where(*urgent)
        asked = []
        for run in session.execute(queued.order_by(order.c.place)):
            if run.owner in over or left[run.owner] <= 0:
                continue
            host = next((one for one in hosts if fits(run, one.worker, moment)), None)
            if host is None:
                continue
            hosts.remove(host)
            left[run.owner] -= 1
            if host.yielding and _ask(session, host.yielding, run.id):
                asked.append(host.yielding)
        return asked


def _hosts(session: Session, alive: Collection[Worker]) -> list[Host]:
    """Return the workers that urgent runs can have; those whose runs have to yield come last.

    Runs that started last yield first. The order is the same at each pass, so that an urgent
    run finds the worker that was asked for it, and another one is not asked too.
    """
    able = {one.name: one for one in alive if one.problem is None}
    columns = (Run.id, Run.worker, Run.requested_state, Run.may_yield, Run.priority)
    computing = select(*columns).where(Run.status == RUNNING, Run.worker.in_(able))
    runs = session.execute(computing.order_by(Run.started_at.desc(), Run.id)).all()
    free = [Host(one, None) for one in idle(session, alive)]
    free += [Host(able[run.worker], None) for run in runs if run.requested_state]
    willing = [run for run in runs if run.may_yield and run.priority != URGENT]
    return free + [Host(able[run.worker], run.id) for run in willing if not run.requested_state]


def _ask(session: Session, run_id: UUID, urgent: UUID) -> bool:
    """Ask a run to yield, unless it has been asked to stop or has stopped meanwhile."""
    free = (Run.status == RUNNING, Run.requested_state.is_(None))
    asked = change(session, run_id, *free, requested_state=QUEUED, requested_at=clock())
    if asked is not None:
        note(session, asked, f"Yields its worker to the urgent run {urgent}.")
    return asked is not None
