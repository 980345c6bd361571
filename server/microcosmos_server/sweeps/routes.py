"""Routes of sweeps: submit all runs at once, estimate, read, rename, and change all runs."""

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Response
from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from microcosmos.spec import estimate
from microcosmos.spec.paths import combinations

from ..auth import tokens
from ..auth.authorize import MAY_READ, Reader, Writer, authorize_owner
from ..core.errors import TooMany
from ..core.json_body import json_route
from ..core.paging import MOMENT, Order, length
from ..estimates import position
from ..estimates.eta import speeds_of
from ..runs import lifecycle
from ..runs.announce import announce as announce_runs
from ..runs.lifecycle import NOT_IN_BIN, WrongState
from ..runs.schemas import Scheduling
from ..runs.submission import (
    Draft,
    IdempotencyKey,
    IdempotentRequest,
    create_runs,
    memory_limit,
    refuse_urgent,
)
from ..services.services import Services, ServicesDep, SessionDep
from ..specs import parsing
from ..specs.parsing import SPEC_BYTES
from ..tables import STATUSES, Idempotency, Run, Sweep, find
from ..workers import registry
from ..workers.registry import progress
from . import summary
from .plan import Plan, plan, refuse_initial, refuse_too_large
from .schemas import (
    CaseRead,
    SkippedRun,
    SweepBrief,
    SweepChange,
    SweepChanged,
    SweepCreate,
    SweepCurves,
    SweepEstimate,
    SweepPage,
    SweepRead,
    SweepRuns,
    SweepSummary,
)

# Few, so that other writers do not wait for long while a large sweep changes.
RUNS_PER_TRANSACTION = 50


def request_of(
    plan: Plan, scheduling: Scheduling, key: str | None = None, owner: UUID | None = None
) -> IdempotentRequest:
    """Return the request for a plan; grids with another order of fields differ."""
    spec = plan.spec.model_dump(mode="json")
    sweep = [plan.name, spec, plan.seeds, list(plan.grid.items())]
    return IdempotentRequest(
        {"sweep": sweep, "scheduling": scheduling.model_dump()}, key, owner
    )


def submit_sweep(
    services: Services,
    plan: Plan,
    request: IdempotentRequest | None = None,
    scheduling: Scheduling | None = None,
) -> tuple[UUID, bool]:
    """Create the sweep and queue its runs; return its id and whether it is new."""
    with services.sessions.read() as session:
        refuse_initial(session, plan)
    scheduling = scheduling or Scheduling()
    request = request or request_of(plan, scheduling)
    sweep = Sweep(
        experiment=plan.spec.experiment,
        name=plan.name,
        spec=plan.spec.model_dump(mode="json"),
        seeds=plan.seeds,
        grid=plan.grid,
        owner=request.owner,
    )
    columns = scheduling.model_dump()
    drafts = [
        Draft(spec, document, {"name": name, **columns}) for name, spec, document in plan.runs()
    ]
    created = create_runs(services, drafts, request, sweep)
    if isinstance(created, Idempotency):
        assert created.sweep is not None
        return created.sweep, False
    announce(services, sweep.id)
    return sweep.id, True


def change_all(
    services: Services,
    sweep_id: UUID,
    change: Callable[[Session, Run], Run],
    among: ColumnElement[bool] = NOT_IN_BIN,
) -> tuple[list[UUID], list[SkippedRun]]:
    """Change each run by itself; return the changed and the skipped ones."""
    with services.sessions.read() as session:
        mine = select(Run.id).where(Run.sweep == sweep_id, among).order_by(Run.sweep_index)
        ids = list(session.scalars(mine))
    changed: list[UUID] = []
    skipped: list[SkippedRun] = []
    for first in range(0, len(ids), RUNS_PER_TRANSACTION):
        some = ids[first : first + RUNS_PER_TRANSACTION]
        with services.sessions.write.begin() as session:
            # In one order, so that two requests cannot deadlock.
            runs = select(Run).where(Run.id.in_(some)).order_by(Run.sweep_index)
            for run in session.scalars(runs).all():
                try:
                    changed.append(change(session, run).id)
                except (WrongState, TooMany) as refusal:
                    session.refresh(run)
                    reason = f"{refusal.detail.rstrip('.')}."
                    values = {"run": run.id, "status": run.status, "reason": reason}
                    skipped.append(SkippedRun.model_validate(values))
        announce_runs(services, *(run_id for run_id in some if run_id in changed))
    announce(services, sweep_id)
    return changed, skipped


def announce(services: Services, sweep_id: UUID) -> None:
    """Publish that a sweep was created or changed; clients read its state themselves."""
    services.events.publish("sweep", sweep_id, {"sweep": str(sweep_id)})


router = APIRouter(prefix="/sweeps", tags=["sweeps"], route_class=json_route(SPEC_BYTES))
LENGTH = length(Sweep.spec) + length(Sweep.grid)
NEWEST_FIRST = Order(
    "-created", Sweep.created_at.expression, MOMENT, Sweep.id, UUID, length=LENGTH
)
Points = Annotated[int | None, Query(ge=2, le=10_000)]


def _sweep(sweep_id: UUID, session: SessionDep) -> Sweep:
    return find(session, Sweep, sweep_id)


SweepDep = Annotated[Sweep, Depends(_sweep)]


def own_sweep(sweep_id: UUID, principal: Writer, services: ServicesDep) -> UUID:
    """Return the id of a path; raise `DomainError` if somebody else owns the sweep."""
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
    request = request_of(plan, scheduling, idempotency_key, principal.token)
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
    """Return sweeps, newest first; `deleted` selects those with all runs in the bin.

    A page has fewer sweeps than `limit` where specs are long.
    """
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
        find(session, Sweep, sweep_id).name = sent.name or None
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


@router.post("/{sweep_id}/uncancel", status_code=202)
def uncancel_sweep(
    sweep_id: OwnSweepId, services: ServicesDep, sent: SweepRuns
) -> SweepChanged:
    """Take the cancellation of some runs back; `skipped` lists those that are not cancelled."""
    chosen = lifecycle.NOT_IN_BIN & Run.id.in_(sent.runs)
    taken_back = _change_all(services, sweep_id, lifecycle.uncancel, chosen)
    services.wake.send()
    return taken_back


@router.delete("/{sweep_id}")
def delete_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Move every run to the bin; `skipped` lists queued and running ones."""
    keep = services.settings.bin_seconds
    return _change_all(
        services, sweep_id, lambda session, run: lifecycle.delete(session, run, keep)
    )


@router.post("/{sweep_id}/restore")
def restore_sweep(sweep_id: OwnSweepId, services: ServicesDep) -> SweepChanged:
    """Restore all runs of the sweep from the bin."""
    return _change_all(services, sweep_id, lifecycle.restore, ~lifecycle.NOT_IN_BIN)


def _change_all(
    services: Services,
    sweep_id: UUID,
    change: Callable[[Session, Run], Run],
    among: ColumnElement[bool] = lifecycle.NOT_IN_BIN,
) -> SweepChanged:
    with services.sessions.read() as session:
        find(session, Sweep, sweep_id)
    changed, skipped = change_all(services, sweep_id, change, among)
    return SweepChanged(**dict(_current(services, sweep_id)), changed=changed, skipped=skipped)


def _current(services: Services, sweep_id: UUID) -> SweepRead:
    with services.sessions.read() as session:
        return read_sweep(session, find(session, Sweep, sweep_id))


def read_sweeps(session: Session, sweeps: Sequence[Sweep]) -> list[SweepBrief]:
    of_sweeps = _runs_of(session, sweeps)
    owners = tokens.owner_names(session, (sweep.owner for sweep in sweeps))
    return [_read(one, of_sweeps[one.id], owners.get(one.owner)) for one in sweeps]


def read_sweep(session: Session, sweep: Sweep) -> SweepRead:
    runs = _runs_of(session, [sweep])[sweep.id]
    owner = tokens.owner_names(session, [sweep.owner]).get(sweep.owner)
    cases = [CaseRead(values=values, runs=[]) for values in combinations(sweep.grid)]
    for run in runs:
        if run.deleted_at is None:
            cases[run.sweep_index % len(cases)].runs.append(run.id)
    return SweepRead(**dict(_read(sweep, runs, owner)), cases=cases)


def _runs_of(session: Session, sweeps: Sequence[Sweep]) -> dict[UUID, list[Any]]:
    of_sweeps: dict[UUID, list[Any]] = defaultdict(list)
    names = ("id", "sweep", "sweep_index", "status", "generation", "generations", "deleted_at")
    columns = [getattr(Run, name) for name in names]
    mine = Run.sweep.in_([sweep.id for sweep in sweeps])
    for row in session.execute(
        select(*columns).where(mine).order_by(Run.sweep, Run.sweep_index)
    ):
        of_sweeps[row.sweep].append(row)
    return of_sweeps


def _read(sweep: Sweep, all_runs: Sequence[Any], owner: str | None) -> SweepBrief:
    runs = [run for run in all_runs if run.deleted_at is None]
    counted = Counter(run.status for run in runs)
    shares = [progress(run) for run in runs]
    names = ("id", "name", "experiment", "spec", "seeds", "grid", "created_at")
    return SweepBrief(
        **{name: getattr(sweep, name) for name in names},
        owner=owner,
        total=len(runs),
        deleted=len(all_runs) - len(runs),
        status_counts={status: counted[status] for status in STATUSES if counted[status]},
        progress=sum(shares) / len(shares) if shares else 1.0,
    )
