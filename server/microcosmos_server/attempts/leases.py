"""Leases: renew one, test whether it has expired, and end it with its job."""

from typing import Any, Literal, NamedTuple
from uuid import UUID

from sqlalchemy import or_, select
from sqlalchemy.orm import Session

from ..core.database import Sessions, ago, clock
from ..runs.announce import announce
from ..runs.lifecycle import change, fail_attempt, fail_unclaimed, release, stop_attempt
from ..services.services import Services
from ..tables import QUEUED, RUNNING, Run
from ..workers import totals

LeaseState = Literal["held", "waiting", "over", "lost"]


def heartbeat(sessions: Sessions, run_id: UUID, worker: str) -> LeaseState:
    """Renew a worker's lease on a run, and return the lease's state.

    `waiting`: its worker has not claimed the run yet. `over`: no worker has it any more.
    `lost`: another worker has the run, so the job must be killed.
    """
    with sessions.write.begin() as session:
        mine = (Run.worker == worker, Run.status.in_((RUNNING, QUEUED)))
        # One UPDATE that names the worker: a worker that was frozen cannot renew a lease that
        # it has lost.
        if run := change(session, run_id, *mine, heartbeat_at=clock()):
            return "held" if run.status == RUNNING else "waiting"
        run = session.get(Run, run_id)
        taken = run and run.worker and run.status in (RUNNING, QUEUED)
        return "lost" if taken else "over"


def lease_expired(session: Session, lease: float) -> Any:
    """Return the condition that a run has had no heartbeat for as long as a lease."""
    return or_(Run.heartbeat_at.is_(None), Run.heartbeat_at < ago(session, lease))


class Progress(NamedTuple):
    """The progress of a run."""

    attempt: int
    """Number of the last attempt."""
    generation: int
    """The last recorded generation."""
    checkpoint: int
    """The generation of the last checkpoint, to which the next attempt returns."""


def progress(services: Services, run_id: UUID) -> Progress | None:
    """Return the progress of a run; None if it is gone."""
    with services.sessions.read() as session:
        columns = (Run.attempt, Run.generation, Run.checkpoint_generation)
        found = session.execute(select(*columns).where(Run.id == run_id)).one_or_none()
    return Progress(*found) if found else None


def end_job(services: Services, run_id: UUID, worker: str, *, broken: bool = False) -> None:
    """End the attempt of a job that its worker has stopped; the run does not count it.

    If the job died because its host is `broken`, the failure counts for the host.
    """
    with services.sessions.write.begin() as session:
        mine = Run.worker == worker
        run = stop_attempt(session, run_id, mine) or release(session, run_id, mine)
        if broken:
            totals.count(session, worker, totals.FAILURES["self-test"])
    _announce(services, run_id, run)


def fail_job(
    services: Services, run_id: UUID, worker: str, error: str, details: str | None = None
) -> None:
    """End the attempt of a job that has died, and count it.

    A job that died before it claimed the run counts too: else it would be tried for ever.
    """
    with services.sessions.write.begin() as session:
        mine = Run.worker == worker
        run = fail_attempt(
            session, run_id, mine, error=error, details=details, reason="process"
        ) or fail_unclaimed(session, run_id, mine, error=error, details=details)
    _announce(services, run_id, run)


def _announce(services: Services, run_id: UUID, run: Run | None) -> None:
    if run:
        announce(services, run_id)
        services.wake.send()
