"""The registry of workers: their reports, and the runs that they compute."""

from collections.abc import Sequence
from typing import Any, Literal
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..core.database import Sessions, ago, clock
from ..tables import FINISHED, RUNNING, Plugin, Run, Worker
from . import totals
from .schemas import RunBrief

STATES = ("idle", "busy", "problem")


def report(
    sessions: Sessions,
    name: str,
    device: str,
    memory_bytes: int,
    status: Literal["idle", "busy"],
    run_id: UUID | None = None,
    xid_errors: int = 0,
    **columns: Any,
) -> None:
    """Report a live worker: its run, and in other columns its load and its plug-ins.

    `xid_errors` is the number of errors of its GPU since the last report.
    """
    defaults = {"kind": "cpu", "problem": None, "problem_kind": None, "gpu": None}
    lists = ("plugins", "unloaded", "device_kinds", "labels")
    columns = {**defaults, **{name: [] for name in lists}, **columns}
    columns |= {"device": device, "memory_bytes": memory_bytes}
    reported = Worker(name=name, status=status, run_id=run_id, **columns)
    with sessions.write.begin() as session:
        known = session.get(Worker, name)
        # Compared before the merge, which overwrites the row.
        same = known is not None and (known.status, known.run_id) == (status, run_id)
        if known is None or known.plugins != reported.plugins:
            for one in reported.plugins:  # They stay known when the worker is gone.
                key = {key: one[key] for key in ("kind", "name", "source")}
                session.merge(Plugin(**key, declaration=dict(one))).seen_at = clock()
        row = session.merge(reported)
        row.heartbeat_at = clock()
        if not same:
            row.since = clock()
        if xid_errors:
            totals.add(session, totals.host_of(name), {totals.XID_ERRORS: xid_errors})


def retire(sessions: Sessions, name: str) -> None:
    with sessions.write.begin() as session:
        session.execute(delete(Worker).where(Worker.name == name))


def live(session: Session, lease: float) -> list[Worker]:
    """Return the workers that reported within a lease, by name."""
    alive = Worker.heartbeat_at >= ago(session, lease)
    return list(session.scalars(select(Worker).where(alive).order_by(Worker.name)))


def state(worker: Worker) -> str:
    """Return one of `STATES`: a worker with a problem takes no run."""
    return "problem" if worker.problem is not None else worker.status


def running(session: Session, alive: Sequence[Worker]) -> dict[str, Run]:
    """Return the runs that some workers compute, by the worker's name."""
    names = [worker.name for worker in alive]
    runs = select(Run).where(Run.status == RUNNING, Run.worker.in_(names))
    return {str(run.worker): run for run in session.scalars(runs)}


def run_brief(run: Run) -> RunBrief:
    names = (name for name in RunBrief.model_fields if name != "progress")
    return RunBrief(**{name: getattr(run, name) for name in names}, progress=progress(run))


def progress(run: Run) -> float:
    """Return the completed share of a run's generations.

    A finished run counts as complete, even if it stopped early.
    """
    return 1.0 if run.status == FINISHED else min(1.0, run.generation / run.generations)
