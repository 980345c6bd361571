"""What workers say about themselves."""

from collections.abc import Sequence
from typing import Any, Literal
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..core.database import Sessions, ago, clock
from ..tables import RUNNING, Plugin, Run, Worker


def report(
    sessions: Sessions,
    name: str,
    device: str,
    memory_bytes: int,
    status: Literal["idle", "busy"],
    run_id: UUID | None = None,
    *,
    kind: Literal["cpu", "gpu"] = "cpu",
    memory_used_bytes: int | None = None,
    load: float | None = None,
    plugins: Sequence[dict[str, Any]] = (),
    unloaded: Sequence[dict[str, Any]] = (),
) -> None:
    """Say that a worker is alive, what it is at, how busy its device is, and what it has of
    users' own."""
    said = Worker(
        name=name,
        device=device,
        kind=kind,
        memory_bytes=memory_bytes,
        memory_used_bytes=memory_used_bytes,
        load=load,
        status=status,
        run_id=run_id,
        plugins=list(plugins),
        unloaded=list(unloaded),
    )
    with sessions.write.begin() as session:
        known = session.get(Worker, name)
        same = known is not None and (known.status, known.run_id) == (status, run_id)
        if known is None or known.plugins != said.plugins:
            _remember(session, said.plugins)
        row = session.merge(said)
        row.heartbeat_at = clock()
        if not same:
            row.since = clock()


def _remember(session: Session, plugins: Sequence[dict[str, Any]]) -> None:
    """Runs may ask for what a worker had that is away by then."""
    for one in plugins:
        row = Plugin(
            kind=one["kind"], name=one["name"], source=one["source"], declaration=dict(one)
        )
        session.merge(row).seen_at = clock()


def retire(sessions: Sessions, name: str) -> None:
    """Say that a worker has ended."""
    with sessions.write.begin() as session:
        session.execute(delete(Worker).where(Worker.name == name))


def live(session: Session, lease: float) -> list[Worker]:
    """Workers that were heard of within a lease, by name."""
    alive = Worker.heartbeat_at >= ago(session, lease)
    return list(session.scalars(select(Worker).where(alive).order_by(Worker.name)))


def at_work(session: Session, alive: Sequence[Worker]) -> dict[str, Run]:
    """The run that each of the workers carries out, by the worker's name."""
    names = [worker.name for worker in alive]
    running = select(Run).where(Run.status == RUNNING, Run.worker.in_(names))
    return {str(run.worker): run for run in session.scalars(running)}
