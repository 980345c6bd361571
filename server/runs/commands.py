"""Shared by the routes of several packages: change a run, then read it as it is now."""

from collections.abc import Callable
from typing import Annotated
from uuid import UUID

from fastapi import Header, Response
from sqlalchemy.orm import Session

from ..services.services import Services
from ..tables import Run
from .announce import announce
from .deps import find_run
from .overview import read_run
from .schemas import RunRead

SPEC_BYTES = 1 << 20
"""Limit on the body of a request with a spec."""

IdempotencyKey = Annotated[
    str | None, Header(alias="Idempotency-Key", min_length=1, max_length=255)
]


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


def submitted(response: Response, run: RunRead, new: bool) -> RunRead:
    """Answer with a run: 202 if it is new, 200 if an earlier request created it."""
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/v1/runs/{run.id}"
    return run


def announced(services: Services, run_id: UUID) -> RunRead:
    return next(iter(announce(services, run_id)), None) or current(services, run_id)


def current(services: Services, run_id: UUID | None) -> RunRead:
    with services.sessions.read() as session:
        return read_run(services, session, session.get_one(Run, run_id))
