"""Create a sweep with all its runs in one transaction, and change all of its runs."""

from collections.abc import Callable
from uuid import UUID

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from ..runs.announce import announce as announce_runs
from ..runs.lifecycle import NOT_IN_BIN, Conflict
from ..runs.schemas import Scheduling
from ..runs.submission import Draft, IdempotentRequest, create_runs
from ..services.services import Services
from ..tables import Idempotency, Run, Sweep
from .plan import Plan, refuse_initial
from .schemas import SkippedRun

RUNS_PER_TRANSACTION = 50
"""Few, so that other writers do not wait for long."""


def request_of(
    plan: Plan, key: str | None = None, owner: UUID | None = None
) -> IdempotentRequest:
    """Return the request for a plan; grids with another order of fields differ."""
    spec = plan.spec.model_dump(mode="json")
    return IdempotentRequest(
        {"sweep": [plan.name, spec, plan.seeds, list(plan.grid.items())]}, key, owner
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
    request = request or request_of(plan)
    sweep = Sweep(
        experiment=plan.spec.experiment,
        name=plan.name,
        spec=plan.spec.model_dump(mode="json"),
        seeds=plan.seeds,
        grid=plan.grid,
        owner=request.owner,
    )
    columns = (scheduling or Scheduling()).model_dump()
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
                except Conflict as refusal:
                    session.refresh(run)
                    values = {"run": run.id, "status": run.status, "reason": f"{refusal}."}
                    skipped.append(SkippedRun.model_validate(values))
        announce_runs(services, *(run_id for run_id in some if run_id in changed))
    announce(services, sweep_id)
    return changed, skipped


def announce(services: Services, sweep_id: UUID) -> None:
    """Publish that a sweep was created or changed; clients read its state themselves."""
    services.events.publish("sweep", sweep_id, {"sweep": str(sweep_id)})
