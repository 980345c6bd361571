"""Routes of sweeps: submit, estimate, read, rename, and change all runs."""

from collections.abc import Callable
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Response
from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from microcosmos.spec import estimate

from ..auth.authorize import MAY_READ, Reader, Writer, authorize_owner
from ..core.errors import ProblemError
from ..core.json_body import json_route
from ..core.paging import MOMENT, Order
from ..deletion import bin
from ..estimates import position
from ..estimates.eta import speeds_of
from ..runs import lifecycle
from ..runs.schemas import Scheduling
from ..runs.submission import IdempotencyKey, memory_limit, refuse_urgent
from ..services.services import Services, ServicesDep, SessionDep
from ..specs import parsing
from ..specs.deps import SPEC_BYTES
from ..tables import Run, Sweep
from ..workers import registry
from . import summary
from .commands import announce, change_all, request_of, submit_sweep
from .overview import read_sweep, read_sweeps
from .plan import Plan, plan, refuse_too_large
from .schemas import (
    SweepChange,
    SweepChanged,
    SweepCreate,
    SweepCurves,
    SweepEstimate,
    SweepPage,
    SweepRead,
    SweepSummary,
)

router = APIRouter(prefix="/sweeps", tags=["sweeps"], route_class=json_route(SPEC_BYTES))
NEWEST_FIRST = Order("-created", Sweep.created_at.expression, MOMENT, Sweep.id, UUID)
Points = Annotated[int | None, Query(ge=2, le=10_000)]


def find_sweep(session: Session, sweep_id: UUID) -> Sweep:
    found = session.get(Sweep, sweep_id)
    if found is None:
        raise ProblemError(404, "Not found", f"No sweep has the id {sweep_id}.")
    return found


def _sweep(sweep_id: UUID, session: SessionDep) -> Sweep:
    return find_sweep(session, sweep_id)


SweepDep = Annotated[Sweep, Depends(_sweep)]


def own_sweep(sweep_id: UUID, principal: Writer, services: ServicesDep) -> UUID:
    """Return the id of a path; raise `ProblemError` if somebody else owns the sweep."""
    authorize_owner(services, principal, Sweep, sweep_id)
    return sweep_id


OwnSweepId = Annotated[UUID, Depends(own_sweep)]


def plan_sent(sent: SweepCreate, services: ServicesDep) -> Plan:
    with parsing.parsing(services) as parse:
        return plan(sent, parse)


PlanDep = Annotated[Plan, Depends(plan_sent)]


@router.post("", status_code=202, responses={200: {"model": SweepRead}})
def create_sweep(
    principal: Writer,
    plan: PlanDep,
    services: ServicesDep,
    response: Response,
    scheduling: Annotated[Scheduling, Query()],
    idempotency_key: IdempotencyKey = None,
) -> SweepRead:
    """Queue all runs of a sweep, or none. The same key with the same request is one sweep."""
    refuse_urgent(principal, scheduling)
    request = request_of(plan, idempotency_key, principal.token)
    known = request.earlier(services)
    sweep_id, new = known.sweep if known else None, False
    if sweep_id is None:
        with services.sessions.read() as session:
            limit = memory_limit(services, session)
        refuse_too_large(plan, limit)
        sweep_id, new = submit_sweep(services, plan, request, scheduling)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/v1/sweeps/{sweep_id}"
    return _current(services, sweep_id)


@router.post("/estimate")
def estimate_sweep(
    principal: Reader, plan: PlanDep, services: ServicesDep, session: SessionDep
) -> SweepEstimate:
    """Return the needs of all runs of a sweep, without queueing them."""
    needs = [estimate(case.spec) for case in plan.cases]
    alive = registry.live(session, services.settings.lease)
    speeds = speeds_of(session, [case.spec for case in plan.cases], alive)
    times = [
        speed.seconds(needed.cell_steps)
        for speed, needed in zip(speeds, needs, strict=True)
        if speed
    ]
    seeds = plan.total // len(plan.cases)
    return SweepEstimate(
        runs=plan.total,
        cases=len(plan.cases),
        memory_bytes=max(needed.memory_bytes for needed in needs),
        memory_limit_bytes=memory_limit(services, session),
        evaluations=seeds * sum(needed.evaluations for needed in needs),
        cell_steps=seeds * sum(needed.cell_steps for needed in needs),
        seconds=seeds * sum(times) if len(times) == len(needs) else None,
        speed=speeds[0].read(needs[0].cell_steps) if speeds[0] else None,
        queue=position.ahead(services, session, principal.token, sweep=True),
    )


@router.get("", dependencies=[MAY_READ])
def list_sweeps(
    session: SessionDep,
    cursor: str | None = None,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    deleted: bool = False,
) -> SweepPage:
    """Return sweeps, newest first; `deleted` selects those with all runs in the bin."""
    kept = select(Run.id).where(Run.sweep == Sweep.id, lifecycle.NOT_IN_BIN).exists()
    listed = select(Sweep).where(~kept if deleted else kept)
    sweeps, following = NEWEST_FIRST.page(session, listed, cursor, limit)
    return SweepPage(items=read_sweeps(session, sweeps), next=following)


@router.get("/{sweep_id}", dependencies=[MAY_READ])
def read(sweep: SweepDep, session: SessionDep) -> SweepRead:
    return read_sweep(session, sweep)


@router.patch("/{sweep_id}")
def change_sweep(
    sweep_id: OwnSweepId,
    services: ServicesDep,
    sent: SweepChange,
) -> SweepRead:
    """Rename a sweep; its runs keep their names."""
    with services.sessions.write.begin() as session:
        find_sweep(session, sweep_id).name = sent.name or None
    announce(services, sweep_id)
    return _current(services, sweep_id)


@router.get("/{sweep_id}/summary", dependencies=[MAY_READ])
def read_summary(sweep: SweepDep, session: SessionDep, points: Points = None) -> SweepSummary:
    """Return median and spread of each case, by generation and at the common generation.

    `points` limits the number of generations, evenly spaced; very many runs reduce it too.
    """
    return summary.summary(session, sweep, points)


@router.get("/{sweep_id}/curves", dependencies=[MAY_READ])
def read_curves(sweep: SweepDep, session: SessionDep, points: Points = None) -> SweepCurves:
    """Return the curves of every run over the same generations."""
    return summary.curves(session, sweep, points)


@router.post("/{sweep_id}/pause", status_code=202)
def pause_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Pause every run that can be paused; `skipped` lists the others."""
    return _change_all(services, sweep_id, lifecycle.pause)


@router.post("/{sweep_id}/resume", status_code=202)
def resume_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Resume every paused run; `skipped` lists the others."""
    resumed = _change_all(services, sweep_id, lifecycle.resume)
    services.wake.send()
    return resumed


@router.post("/{sweep_id}/cancel", status_code=202)
def cancel_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Cancel every run that has not ended; `skipped` lists the others."""
    return _change_all(services, sweep_id, lifecycle.cancel)


@router.delete("/{sweep_id}")
def delete_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Move every run to the bin; `skipped` lists queued and running ones."""
    keep = services.settings.bin_seconds
    return _change_all(services, sweep_id, lambda session, run: bin.put(session, run, keep))


@router.post("/{sweep_id}/restore")
def restore_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Restore all runs of the sweep from the bin."""
    return _change_all(services, sweep_id, bin.restore, ~lifecycle.NOT_IN_BIN)


def _change_all(
    services: Services,
    sweep_id: UUID,
    change: Callable[[Session, Run], Run],
    among: ColumnElement[bool] = lifecycle.NOT_IN_BIN,
) -> SweepChanged:
    with services.sessions.read() as session:
        find_sweep(session, sweep_id)
    changed, skipped = change_all(services, sweep_id, change, among)
    return SweepChanged(**dict(_current(services, sweep_id)), changed=changed, skipped=skipped)


def _current(services: Services, sweep_id: UUID) -> SweepRead:
    with services.sessions.read() as session:
        return read_sweep(session, find_sweep(session, sweep_id))
