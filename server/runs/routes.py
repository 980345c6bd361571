"""Routes of runs: estimate, submit, list, read, edit, pause, resume and cancel."""

from typing import Annotated, Literal
from uuid import UUID

from fastapi import APIRouter, Query, Request, Response
from sqlalchemy.orm import Session

from microcosmos.spec import EXPERIMENTS, drawing, estimate

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, Reader, Writer
from ..core.errors import invalid_field
from ..core.json_body import json_route
from ..estimates import position
from ..estimates.eta import speeds_of
from ..estimates.schemas import EstimateRead
from ..services.services import ServicesDep, SessionDep
from ..specs.deps import SPEC_BYTES, SpecDep
from ..specs.schemas import DrawingRead
from ..tables import Run, Status
from ..workers import registry
from . import lifecycle, listing
from .announce import changed
from .deps import AnyRunDep, OwnRunId
from .overview import read_run, read_runs
from .schemas import RunChange, RunPage, RunRead, Submission
from .submission import (
    IdempotencyKey,
    IdempotentRequest,
    answer,
    memory_limit,
    refuse_urgent,
)

router = APIRouter(prefix="/runs", tags=["runs"], route_class=json_route(SPEC_BYTES))


@router.post("", status_code=202, responses={200: {"model": RunRead}})
def create_run(
    principal: Writer,
    spec: SpecDep,
    services: ServicesDep,
    response: Response,
    asked: Annotated[Submission, Query()],
    idempotency_key: IdempotencyKey = None,
) -> RunRead:
    """Queue a run. The same key with the same spec gives the same run, with 200."""
    refuse_urgent(principal, asked)
    request = IdempotentRequest(spec.model_dump(mode="json"), idempotency_key, principal.token)
    columns = {**asked.model_dump(), "name": asked.name or None}
    return answer(services, response, request, lambda: (spec, columns))


@router.post("/estimate")
def estimate_run(
    principal: Reader, spec: SpecDep, services: ServicesDep, session: SessionDep
) -> EstimateRead:
    """Return the needs of a run and a drawing, without queueing it."""
    needed = estimate(spec)
    alive = registry.live(session, services.settings.lease)
    (speed,) = speeds_of(session, [spec], alive)
    return EstimateRead(
        memory_bytes=needed.memory_bytes,
        memory_limit_bytes=memory_limit(services, session),
        evaluations=needed.evaluations,
        cell_steps=needed.cell_steps,
        seconds=speed.seconds(needed.cell_steps) if speed else None,
        speed=speed.read(needed.cell_steps) if speed else None,
        queue=position.ahead(services, session, principal.token),
        drawing=DrawingRead.model_validate(drawing(spec)),
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
    """Return runs with any of these states and experiments, this tag and this text.

    `q` searches names, tags, notes and the start of ids. `sweep` is an id, or `none`. With `-`
    the sort is descending; runs without a value come last. `deleted` selects the bin.
    """
    for name in experiment:
        if name not in EXPERIMENTS:
            raise invalid_field("experiment", f"one of {', '.join(EXPERIMENTS)}", name)
    statement = listing.matching(status, experiment, tag, q, sweep, deleted)
    runs, following = listing.order(sort).page(session, statement, cursor, limit)
    return RunPage(items=read_runs(services, session, runs), next=following)


@router.get("/{run_id}", dependencies=[MAY_READ_SHARED])
def read(run: AnyRunDep, services: ServicesDep, session: SessionDep) -> RunRead:
    return read_run(services, session, run)


@router.patch("/{run_id}")
def change_run(
    request: Request, run_id: OwnRunId, services: ServicesDep, sent: RunChange
) -> RunRead:
    """Change a run's name, tags, note or scheduling."""
    refuse_urgent(request.state.principal, sent)
    values = sent.values()

    def edit(session: Session, run: Run) -> Run:
        return lifecycle.change(session, run.id, **values) or run if values else run

    run = changed(services, run_id, edit)
    services.wake.send()
    return run


@router.post("/{run_id}/pause", status_code=202)
def pause_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.pause)


@router.post("/{run_id}/resume", status_code=202)
def resume_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    run = changed(services, run_id, lifecycle.resume)
    services.wake.send()
    return run


@router.post("/{run_id}/cancel", status_code=202)
def cancel_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.cancel)
