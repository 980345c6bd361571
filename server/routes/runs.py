"""Runs: submit, list, read, pause, resume, cancel."""

from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Callable
from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Query, Response
from sqlalchemy import and_, or_, select
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, estimate, parse

from .. import lifecycle
from ..deps import RunDep, ServicesDep, SessionDep, find_run
from ..models import Run
from ..problems import Refused
from ..progress import read_run, read_runs
from ..reconcile import requeue
from ..schemas import EstimateRead, RunPage, RunRead, Status
from ..services import Services
from ..submission import memory_limit, refuse_too_large, submit
from ..uploads import json_object

SPEC_BYTES = 1 << 20

router = APIRouter(prefix="/runs", tags=["runs"])
body: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": {"type": "object"}}},
    }
}


def spec_sent(document: Annotated[dict[str, Any], Depends(json_object(SPEC_BYTES))]) -> Spec:
    return parse(document)


SpecDep = Annotated[Spec, Depends(spec_sent)]
Key = Annotated[str | None, Header(alias="Idempotency-Key", min_length=1, max_length=255)]


@router.post("", status_code=202, openapi_extra=body)
def create_run(
    spec: SpecDep, services: ServicesDep, response: Response, idempotency_key: Key = None
) -> RunRead:
    """Queue a run. The same key with the same spec is the same run, answered with 200."""
    refuse_too_large(services, spec)
    run, new = submit(services, spec, idempotency_key)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/v1/runs/{run.id}"
    return _current(services, run.id)


@router.post("/estimate", openapi_extra=body)
def estimate_run(spec: SpecDep, services: ServicesDep, session: SessionDep) -> EstimateRead:
    """What a run will need, without queueing it."""
    needed = estimate(spec)
    return EstimateRead(
        memory_bytes=needed.memory_bytes,
        memory_limit_bytes=memory_limit(services, session),
        evaluations=needed.evaluations,
        cell_steps=needed.cell_steps,
    )


@router.get("")
def list_runs(
    session: SessionDep,
    cursor: str | None = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
    status: Status | None = None,
) -> RunPage:
    """The newest first."""
    statement = select(Run).order_by(Run.created_at.desc(), Run.id.desc()).limit(limit + 1)
    if status:
        statement = statement.where(Run.status == status)
    if cursor:
        created, last = _position(cursor)
        same = and_(Run.created_at == created, Run.id < last)
        statement = statement.where(or_(Run.created_at < created, same))
    runs = list(session.scalars(statement))
    more = len(runs) > limit
    items = read_runs(session, runs[:limit])
    return RunPage(items=items, next=_cursor(runs[limit - 1]) if more else None)


@router.get("/{run_id}")
def read(run: RunDep, session: SessionDep) -> RunRead:
    return read_run(session, run)


@router.post("/{run_id}/pause", status_code=202)
def pause_run(run_id: UUID, services: ServicesDep) -> RunRead:
    return _changed(services, run_id, lifecycle.pause)


@router.post("/{run_id}/resume", status_code=202)
def resume_run(run_id: UUID, services: ServicesDep) -> RunRead:
    changed = _changed(services, run_id, lifecycle.resume)
    requeue(services, run_id)
    return changed


@router.post("/{run_id}/cancel", status_code=202)
def cancel_run(run_id: UUID, services: ServicesDep) -> RunRead:
    return _changed(services, run_id, lifecycle.cancel)


def _changed(
    services: Services, run_id: UUID, change: Callable[[Session, Run], Run]
) -> RunRead:
    """With one connection at a time: requests that held two could wait for each other."""
    with services.sessions.write.begin() as session:
        change(session, find_run(session, run_id))
    lifecycle.announce(services, run_id)
    return _current(services, run_id)


def _current(services: Services, run_id: UUID) -> RunRead:
    with services.sessions.read() as session:
        return read_run(session, session.get_one(Run, run_id))


def _cursor(run: Run) -> str:
    return urlsafe_b64encode(f"{run.created_at.isoformat()} {run.id}".encode()).decode()


def _position(cursor: str) -> tuple[datetime, UUID]:
    try:
        created, _, last = urlsafe_b64decode(cursor).decode().partition(" ")
        return datetime.fromisoformat(created), UUID(last)
    except ValueError:
        detail = f"`cursor` must be the `next` of an earlier answer; got {cursor!r:.80}."
        raise Refused(422, "Invalid input", detail) from None
