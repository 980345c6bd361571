"""From a plan to a sweep and its queued runs, in one transaction."""

from datetime import timedelta
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.version import VERSION

from ..core.database import clock
from ..creatures import initial
from ..runs import idempotency
from ..services.services import Services
from ..tables import LogEntry, Run, Sweep
from ..workers import plugins
from .planning import Plan, refuse_origins
from .steering import announce


def submit_sweep(
    services: Services, plan: Plan, key: str | None = None, owner: UUID | None = None
) -> tuple[UUID, bool]:
    """The sweep of a plan and whether it is new; the same key with the same plan is one."""
    with services.sessions.read() as session:
        refuse_origins(session, plan)
    try:
        with services.sessions.write.begin() as session:
            sweep = _write(session, plan, key, owner)
            runs = _write_runs(session, plan, sweep)
    except IntegrityError:
        known = earlier_sweep(services, plan, key, owner)
        if known is None:
            raise
        return known, False
    # Committed before they are enqueued: workers must find the rows.
    services.jobs.enqueue(runs)
    announce(services, sweep.id)
    return sweep.id, True


def earlier_sweep(
    services: Services, plan: Plan, key: str | None, owner: UUID | None
) -> UUID | None:
    """The sweep that a key stands for already; `ProblemError` where another request did."""
    known = idempotency.earlier(services, key, owner, _request(plan))
    return known.sweep if known else None


def _write(session: Session, plan: Plan, key: str | None, owner: UUID | None) -> Sweep:
    sweep = Sweep(
        experiment=plan.spec.experiment,
        name=plan.name,
        spec=plan.spec.model_dump(mode="json"),
        seeds=plan.seeds,
        grid=plan.grid,
        owner=owner,
    )
    session.add(sweep)
    session.flush()
    idempotency.remember(session, key, owner, _request(plan), sweep=sweep.id)
    return sweep


def _write_runs(session: Session, plan: Plan, sweep: Sweep) -> list[Run]:
    """Their rows, a microsecond apart: lists and the queue have them in their own order."""
    now = session.execute(select(clock())).scalar_one()
    generations = [case.spec.generations for case in plan.cases]
    runs = [
        Run(
            experiment=sweep.experiment,
            spec=spec,
            plugin_versions=plugins.needed_versions(spec),
            generations=generations[place % len(generations)],
            version=VERSION,
            name=name,
            sweep=sweep.id,
            owner=sweep.owner,
            sweep_index=place,
            created_at=now + timedelta(microseconds=place),
            queued_at=now + timedelta(microseconds=place),
        )
        for place, (name, spec) in enumerate(plan.runs())
    ]
    session.add_all(runs)
    session.flush()
    session.add_all(_first_entry(run, len(runs)) for run in runs)
    ids = [run.id for run in runs]
    several = len(plan.cases)
    initial.keep(session, [(case.spec, ids[i::several]) for i, case in enumerate(plan.cases)])
    return runs


def _first_entry(run: Run, total: int) -> LogEntry:
    text = f"Submitted: {run.experiment}, {run.generations} generations; run "
    text += f"{(run.sweep_index or 0) + 1} of a sweep of {total}."
    return LogEntry(run_id=run.id, attempt=0, level="info", text=text)


def _request(plan: Plan) -> dict[str, object]:
    """What two requests under one key must have in common; grids with their order."""
    spec = plan.spec.model_dump(mode="json")
    return {"sweep": [plan.name, spec, plan.seeds, list(plan.grid.items())]}
