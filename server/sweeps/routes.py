"""Sweeps: many runs that are asked for, looked at and steered together."""

from collections.abc import Callable
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Response
from sqlalchemy import ColumnElement
from sqlalchemy.orm import Session

from microcosmos.spec import estimate

from ..auth.authorize import MAY_READ, Writer
from ..core.uploads import json_route
from ..deletion import bin
from ..estimates import position
from ..estimates.eta import speeds_of
from ..queue.order import requeue
from ..runs import lifecycle
from ..runs.commands import SPEC_BYTES, IdempotencyKey
from ..runs.submission import memory_limit
from ..services.deps import ServicesDep, SessionDep
from ..services.services import Services
from ..specs import parsing
from ..tables import Run
from . import summary
from .deps import OwnSweepId, SweepDep, find_sweep
from .planning import Plan, plan, refuse_too_large
from .schemas import (
    SweepChange,
    SweepChanged,
    SweepCurves,
    SweepEstimate,
    SweepPage,
    SweepRead,
    SweepSent,
    SweepSummary,
)
from .steering import announce, page, read_sweep, steer
from .submission import earlier_sweep, submit_sweep

router = APIRouter(prefix="/sweeps", tags=["sweeps"], route_class=json_route(SPEC_BYTES))
Points = Annotated[int | None, Query(ge=2, le=10_000)]


def plan_sent(sent: SweepSent, services: ServicesDep) -> Plan:
    with parsing.parsing(services) as parse:
        return plan(sent, parse)


PlanDep = Annotated[Plan, Depends(plan_sent)]


@router.post("", status_code=202)
def create_sweep(
    principal: Writer,
    plan: PlanDep,
    services: ServicesDep,
    response: Response,
    idempotency_key: IdempotencyKey = None,
) -> SweepRead:
    """Queue all runs of a sweep, or none. The same key with the same request is the same."""
    sweep_id, new = earlier_sweep(services, plan, idempotency_key, principal.token), False
    if sweep_id is None:
        with services.sessions.read() as session:
            limit = memory_limit(services, session)
        refuse_too_large(plan, limit)
        sweep_id, new = submit_sweep(services, plan, idempotency_key, principal.token)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/v1/sweeps/{sweep_id}"
    return _current(services, sweep_id)


@router.post("/estimate", dependencies=[MAY_READ])
def estimate_sweep(plan: PlanDep, services: ServicesDep, session: SessionDep) -> SweepEstimate:
    """What all runs of a sweep will need, without queueing them."""
    needs = [estimate(case.spec) for case in plan.cases]
    line = position.line(services, session)
    speeds = speeds_of(session, [case.spec for case in plan.cases], line.alive)
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
        queue=line.ahead(sweep=True),
    )


@router.get("", dependencies=[MAY_READ])
def list_sweeps(
    session: SessionDep,
    cursor: Annotated[str | None, Query(max_length=100)] = None,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    deleted: bool = False,
) -> SweepPage:
    """Newest first; of `deleted` ones all runs lie in the bin."""
    return page(session, cursor, limit, deleted)


@router.get("/{sweep_id}", dependencies=[MAY_READ])
def read(sweep: SweepDep, session: SessionDep) -> SweepRead:
    return read_sweep(session, sweep)


@router.patch("/{sweep_id}")
def change_sweep(
    sweep_id: OwnSweepId,
    services: ServicesDep,
    sent: SweepChange,
) -> SweepRead:
    """Say what a sweep is called; its runs keep their names."""
    with services.sessions.write.begin() as session:
        find_sweep(session, sweep_id).name = sent.name or None
    announce(services, sweep_id)
    return _current(services, sweep_id)


@router.get("/{sweep_id}/summary", dependencies=[MAY_READ])
def read_summary(sweep: SweepDep, session: SessionDep, points: Points = None) -> SweepSummary:
    """Median and spread of each case, by generation and at last.

    Of all generations, or of about so many, evenly spaced; of fewer where there are very many
    runs.
    """
    return summary.summary(session, sweep, points)


@router.get("/{sweep_id}/curves", dependencies=[MAY_READ])
def read_curves(sweep: SweepDep, session: SessionDep, points: Points = None) -> SweepCurves:
    """The curves of every run by itself, over the same generations."""
    return summary.curves(session, sweep, points)


@router.post("/{sweep_id}/pause", status_code=202)
def pause_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Pause every run that can be paused; `skipped` tells of those that cannot."""
    return _steered(services, sweep_id, lifecycle.pause)


@router.post("/{sweep_id}/resume", status_code=202)
def resume_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Resume every run that is paused; `skipped` tells of the others."""
    resumed = _steered(services, sweep_id, lifecycle.resume)
    requeue(services.sessions, services.jobs, *resumed.changed)
    return resumed


@router.post("/{sweep_id}/cancel", status_code=202)
def cancel_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Cancel every run that has not ended; `skipped` tells of those that have."""
    return _steered(services, sweep_id, lifecycle.cancel)


@router.delete("/{sweep_id}")
def delete_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Every run into the bin; `skipped` tells of those that wait or are at work."""
    keep = services.settings.bin_seconds
    return _steered(services, sweep_id, lambda session, run: bin.put(session, run, keep))


@router.post("/{sweep_id}/restore")
def restore_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Every run that lies in the bin out of it, as it was."""
    return _steered(services, sweep_id, bin.restore, ~lifecycle.KEPT)


def _steered(
    services: Services,
    sweep_id: UUID,
    change: Callable[[Session, Run], Run],
    among: ColumnElement[bool] = lifecycle.KEPT,
) -> SweepChanged:
    with services.sessions.read() as session:
        find_sweep(session, sweep_id)
    changed, skipped = steer(services, sweep_id, change, among)
    return SweepChanged(**dict(_current(services, sweep_id)), changed=changed, skipped=skipped)


def _current(services: Services, sweep_id: UUID) -> SweepRead:
    with services.sessions.read() as session:
        return read_sweep(session, find_sweep(session, sweep_id))
