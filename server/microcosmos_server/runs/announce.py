"""Change runs, and publish events of runs after a transaction has changed them."""

import json
import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from ..services.services import Services
from ..tables import Run
from .deps import find_run
from .overview import read_run, read_runs
from .schemas import RunRead

log = logging.getLogger(__name__)

VOLATILE_FIELDS = {
    *("generation", "progress", "evaluations", "qd_score", "coverage", "best", "infeasible"),
    *("corrected_qd_score", "corrected_coverage", "hit_rate"),
    *("sparkline", "evaluations_per_second", "eta_seconds", "summary", "waiting_reason"),
}
"""Fields that may differ at each reading; changes of these alone cause no event."""


SPEC_BYTES = 20_000
"""Longest spec, as JSON, in an event. Redis keeps thousands of events, and pages that lack the
spec of a run ask for it."""
SENT_SECONDS = 0.05
"""Longest time to wait until events are sent; a silent Redis drops them at once."""


def announce(
    services: Services, *run_ids: UUID, without: Collection[str] = ()
) -> list[RunRead]:
    """Publish an event for each run, `without` some fields and a long spec; return the runs.

    A slow reader may publish a stale state after a newer one. So the runs are read again after
    publishing, and those that have changed are published again. A failure is only logged: the
    change is already committed.
    """
    published: dict[UUID, RunRead] = {}
    try:
        while changed_runs := _changed_runs(services, run_ids, published):
            for run in changed_runs:
                data = run.model_dump(mode="json", exclude=set(without))
                if len(json.dumps(data.get("spec"))) > SPEC_BYTES:
                    del data["spec"]
                services.events.publish("run", run.id, data)
                published[run.id] = run
            services.events.messenger.flush(SENT_SECONDS)
    except SQLAlchemyError as error:
        log.warning("no event of runs %s: %s", ", ".join(map(str, run_ids)), error)
    return list(published.values())


def _changed_runs(
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
                if row.id not in published or _stable(run) != _stable(published[row.id])
            ]
        return read_runs(services, session, rows) if rows else []


def _stable(run: RunRead) -> dict[str, Any]:
    return run.model_dump(exclude=VOLATILE_FIELDS)


def announced(services: Services, run_id: UUID) -> RunRead:
    return next(iter(announce(services, run_id)), None) or current(services, run_id)


def current(services: Services, run_id: UUID | None) -> RunRead:
    with services.sessions.read() as session:
        return read_run(services, session, session.get_one(Run, run_id))


def changed(
    services: Services,
    run_id: UUID,
    change: Callable[[Session, Run], Run],
    deleted: bool = False,
) -> RunRead:
    """Change a run in a transaction, announce it and read it.

    A request holds one connection at a time: with two, requests could wait for each other.
    """
    with services.sessions.write.begin() as session:
        change(session, find_run(session, run_id, deleted))
    return announced(services, run_id)
