"""Estimate, submit, list, read, name, pause, resume and cancel runs."""

from typing import Annotated, Any, Literal
from uuid import UUID

from fastapi import APIRouter, Body, Depends, Query, Response
from pydantic import StringConstraints
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.spec import EXPERIMENTS, Spec, drawing, estimate

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, Writer
from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..core.uploads import json_route
from ..estimates import position
from ..estimates.eta import speed_of
from ..estimates.schemas import EstimateRead
from ..queue.order import requeue
from ..services.deps import ServicesDep, SessionDep
from ..specs import parsing
from ..specs.drawings import drawing_read
from ..tables import Run, Status
from . import lifecycle, listing
from .commands import SPEC_BYTES, IdempotencyKey, changed, current, submitted
from .deps import AnyRunDep, OwnRunId
from .idempotency import earlier
from .overview import read_run, read_runs
from .schemas import NAME, RunChange, RunPage, RunRead
from .submission import memory_limit, refuse_too_large, submit

router = APIRouter(prefix="/runs", tags=["runs"], route_class=json_route(SPEC_BYTES))


Document = Annotated[dict[str, Any], Body()]
"""A spec, which `microcosmos.spec` checks: its messages name fields as people write them."""


def spec_sent(document: Document, services: ServicesDep) -> Spec:
    return parsing.parse(services, document)


SpecDep = Annotated[Spec, Depends(spec_sent)]


Called = Annotated[
    str | None,
    StringConstraints(strip_whitespace=True, max_length=NAME, pattern=r"^[^\x00]*$"),
    Query(),
]


@router.post("", status_code=202)
def create_run(
    principal: Writer,
    spec: SpecDep,
    services: ServicesDep,
    response: Response,
    idempotency_key: IdempotencyKey = None,
    name: Called = None,
) -> RunRead:
    """Queue a run. The same key with the same spec is the same run, answered with 200.

    `name` is what it is called, as `PATCH` could say later.
    """
    if known := earlier(
        services, idempotency_key, principal.token, spec.model_dump(mode="json")
    ):
        return submitted(response, current(services, known.run_id), new=False)
    refuse_too_large(services, spec)
    run, new = submit(services, spec, idempotency_key, owner=principal.token, name=name or None)
    return submitted(response, run, new)


@router.post("/estimate", dependencies=[MAY_READ])
def estimate_run(spec: SpecDep, services: ServicesDep, session: SessionDep) -> EstimateRead:
    """What a run will need, and what it is about, without queueing it."""
    needed = estimate(spec)
    line = position.line(services, session)
    speed = speed_of(session, spec, line.alive)
    return EstimateRead(
        memory_bytes=needed.memory_bytes,
        memory_limit_bytes=memory_limit(services, session),
        evaluations=needed.evaluations,
        cell_steps=needed.cell_steps,
        seconds=speed.seconds(needed.cell_steps) if speed else None,
        speed=speed.read(needed.cell_steps) if speed else None,
        queue=line.ahead(),
        drawing=drawing_read(drawing(spec)),
    )


Text = Annotated[str, Query(min_length=1, max_length=200, pattern=r"^[^\x00]*$")]


@router.get("", dependencies=[MAY_READ])
def list_runs(
    services: ServicesDep,
    session: SessionDep,
    cursor: str | None = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
    status: Annotated[list[Status], Query()] = [],  # noqa: B006
    experiment: Annotated[list[str], Query()] = [],  # noqa: B006
    tag: Text | None = None,
    q: Text | None = None,
    sweep: UUID | Literal["none"] | None = None,
    sort: listing.Sort = "-created",
    deleted: bool = False,
) -> RunPage:
    """Runs of any of these states and experiments, with this tag and this text.

    `q` is looked for in names, tags and notes and at the beginning of ids; `sweep` is one, or
    `none`. With `-`, the sort is descending; runs without a value come last. `deleted` ones
    lie in the bin.
    """
    _refuse_unknown(experiment)
    statement = listing.matching(select(Run), status, experiment, tag, q, sweep, deleted)
    rows = listing.page(session, statement, sort, cursor, limit)
    items = read_runs(services, session, [run for run, _ in rows[:limit]])
    return RunPage(items=items, next=listing.cursor(sort, rows, limit))


def _refuse_unknown(experiments: list[str]) -> None:
    for name in experiments:
        if name not in EXPERIMENTS:
            known = ", ".join(EXPERIMENTS)
            message = f"needs one of {known}; got {name!r}"
            error = FieldError(field="experiment", message=message, needed=known, got=name)
            raise ProblemError(422, "Invalid input", f"experiment: {message}", [error])


@router.get("/{run_id}", dependencies=[MAY_READ_SHARED])
def read(run: AnyRunDep, services: ServicesDep, session: SessionDep) -> RunRead:
    return read_run(services, session, run)


@router.patch("/{run_id}")
def change_run(run_id: OwnRunId, services: ServicesDep, sent: RunChange) -> RunRead:
    """Say what a run is called, its tags or a note; what it computes stays as it is."""
    said = sent.said()

    def say(session: Session, run: Run) -> Run:
        return lifecycle.change(session, run.id, **said) or run if said else run

    return changed(services, run_id, say)


@router.post("/{run_id}/pause", status_code=202)
def pause_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.pause)


@router.post("/{run_id}/resume", status_code=202)
def resume_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    run = changed(services, run_id, lifecycle.resume)
    requeue(services.sessions, services.jobs, run_id)
    return run


@router.post("/{run_id}/cancel", status_code=202)
def cancel_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.cancel)
