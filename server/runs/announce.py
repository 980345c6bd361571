"""Publish events of runs, after a transaction has changed them."""

import logging
from collections.abc import Collection, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from ..services.services import Services
from ..tables import Run
from .overview import read_runs
from .schemas import RunRead

log = logging.getLogger(__name__)

CHANGING = {
    *("generation", "progress", "evaluations", "qd_score", "coverage", "best", "diverged"),
    *("sparkline", "evaluations_per_second", "eta_seconds", "summary", "waiting_reason"),
}
"""Fields that may differ at each reading; events of generations contain them too."""


def announce(
    services: Services, *run_ids: UUID, without: Collection[str] = ()
) -> list[RunRead]:
    """Publish an event for each run, `without` some fields, and return the runs.

    A slow reader may publish a stale state after a newer one. So the runs are read again after
    publishing, and those that have changed are published again. A failure is only logged: the
    change is already committed.
    """
    published: dict[UUID, RunRead] = {}
    try:
        while news := _news(services, run_ids, published):
            for run in news:
                data = run.model_dump(mode="json", exclude=set(without))
                services.events.publish("run", run.id, data)
                published[run.id] = run
    except SQLAlchemyError as error:
        log.warning("no event of runs %s: %s", ", ".join(map(str, run_ids)), error)
    return list(published.values())


def _news(
    services: Services, run_ids: Sequence[UUID], published: Mapping[UUID, RunRead]
) -> Sequence[RunRead]:
    """Read the runs that differ from those published; read the queue only for these."""
    with services.sessions.read() as session:
        rows = session.scalars(select(Run).where(Run.id.in_(run_ids))).all()
        if published:
            now = read_runs(services, session, rows, queue=False)
            rows = [
                row
                for row, run in zip(rows, now, strict=True)
                if row.id not in published or _facts(run) != _facts(published[row.id])
            ]
        return read_runs(services, session, rows) if rows else []


def _facts(run: RunRead) -> dict[str, Any]:
    return run.model_dump(exclude=CHANGING)
