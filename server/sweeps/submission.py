"""Create a sweep from a plan, with all its runs, in one transaction."""

from uuid import UUID

from ..runs.submission import Draft, IdempotentRequest, create_runs
from ..services.services import Services
from ..tables import Idempotency, Sweep
from .commands import announce
from .plan import Plan, refuse_initial


def request_of(
    plan: Plan, key: str | None = None, owner: UUID | None = None
) -> IdempotentRequest:
    """Return the request for a plan; grids with another order of fields differ."""
    spec = plan.spec.model_dump(mode="json")
    return IdempotentRequest(
        {"sweep": [plan.name, spec, plan.seeds, list(plan.grid.items())]}, key, owner
    )


def submit_sweep(
    services: Services, plan: Plan, request: IdempotentRequest | None = None
) -> tuple[UUID, bool]:
    """Create the sweep and enqueue its runs; return its id and whether it is new."""
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
    drafts = [Draft(spec, document, {"name": name}) for name, spec, document in plan.runs()]
    created = create_runs(services, drafts, request, sweep)
    if isinstance(created, Idempotency):
        assert created.sweep is not None
        return created.sweep, False
    announce(services, sweep.id)
    return sweep.id, True
