"""The reconciler: repair runs that lack their worker, and delete expired rows.

A server runs it every few seconds; several servers take turns.
"""

import logging
import time
from contextlib import AbstractContextManager
from threading import Event

from sqlalchemy import delete, or_, select, update

from ..attempts import leases
from ..attempts.preemption import make_room
from ..core.database import ago, clock
from ..deletion.purge import purge
from ..deletion.retention import expire
from ..runs.announce import announce
from ..runs.lifecycle import end_attempt, fail_attempt, release
from ..runs.log import note
from ..services.periodic import repeating
from ..services.services import Services
from ..tables import CANCELLED, QUEUED, RUNNING, InstallationState, Run, Sweep, Worker

SILENT_SECONDS = 3600.0
"""Seconds of silence after which a worker is deleted."""
EXPIRE_SECONDS = 3600.0
"""Seconds between two searches for what the settings no longer keep."""

TURN = 0.9
"""Part of the interval after which the next pass may begin."""

log = logging.getLogger(__name__)


def reconciling(services: Services) -> AbstractContextManager[None]:
    """Reconcile every few seconds, in a thread, until the end of the block.

    Servers over one database take turns: one pass an interval is enough for all.
    """
    expire_at = 0.0

    def take_pass(_: Event) -> None:
        nonlocal expire_at
        began = time.monotonic()
        if take_turn(services):
            reconcile(services)
            if time.monotonic() >= expire_at:
                expire(services)
                expire_at = time.monotonic() + EXPIRE_SECONDS
            note_pass(services, time.monotonic() - began)

    return repeating("reconciler", services.settings.reconcile_interval, take_pass)


def take_turn(services: Services) -> bool:
    """Return True unless another server began a pass within the interval."""
    with services.sessions.write.begin() as session:
        last = InstallationState.reconciled_at
        begun = ago(session, TURN * services.settings.reconcile_interval)
        due = update(InstallationState).where(or_(last.is_(None), last <= begun))
        taken = session.execute(due.values(reconciled_at=clock()).returning(last))
        return taken.one_or_none() is not None


def note_pass(services: Services, seconds: float) -> None:
    """Record a complete pass: if there is none for long, somebody has to look."""
    done = update(InstallationState).values(passed_at=clock(), pass_seconds=seconds)
    with services.sessions.write.begin() as session:
        session.execute(done)


def reconcile(services: Services) -> None:
    """Do all periodic work once."""
    cancel_overdue(services)
    requeue_expired(services)
    release_unclaimed(services)
    make_room(services)
    services.jobs.clean()
    delete_silent_workers(services)
    purge(services)
    delete_empty_sweeps(services)


def cancel_overdue(services: Services) -> None:
    """Cancel runs whose workers did not stop in time. Their supervisors kill the jobs."""
    grace = services.settings.grace
    with services.sessions.read() as session:
        overdue = (
            Run.status == RUNNING,
            Run.requested_state == CANCELLED,
            Run.requested_at < ago(session, grace),
        )
        found = list(session.scalars(select(Run.id).where(*overdue)))
    for run_id in found:
        with services.sessions.write.begin() as session:
            ended = end_attempt(session, run_id, *overdue)
            if ended:
                text = f"Cancelled: its worker did not stop within {grace:g} s."
                note(session, ended, text, "warning")
        if ended:
            announce(services, run_id)


def requeue_expired(services: Services) -> None:
    """End the attempts whose lease has expired, and queue their runs again."""
    lease = services.settings.lease
    with services.sessions.read() as session:
        expired = (Run.status == RUNNING, leases.lease_expired(session, lease))
        found = session.execute(select(Run.id, Run.worker).where(*expired)).all()
    for run_id, worker in found:
        with services.sessions.write.begin() as session:
            error = f"worker {worker} has not reported for {lease:g} s"
            run = fail_attempt(session, run_id, *expired, error=error, reason="silence")
        if run:
            announce(services, run_id)
            services.wake.send()


def release_unclaimed(services: Services) -> None:
    """Take runs back from workers that died between taking and claiming them."""
    with services.sessions.read() as session:
        silent = leases.lease_expired(session, services.settings.lease)
        taken = (Run.status == QUEUED, Run.worker.is_not(None), silent)
        found = list(session.scalars(select(Run.id).where(*taken)))
    for run_id in found:
        with services.sessions.write.begin() as session:
            run = release(session, run_id, silent)
        if run:
            announce(services, run_id)
            services.wake.send()


def delete_empty_sweeps(services: Services) -> None:
    """Delete sweeps whose last run is purged."""
    alone = ~select(Run.id).where(Run.sweep == Sweep.id).exists()
    with services.sessions.read() as session:
        found = session.scalars(select(Sweep.id).where(alone)).all()
    if found:
        with services.sessions.write.begin() as session:
            session.execute(delete(Sweep).where(Sweep.id.in_(found), alone))


def delete_silent_workers(services: Services) -> None:
    with services.sessions.write.begin() as session:
        old = Worker.heartbeat_at < ago(session, SILENT_SECONDS)
        session.execute(delete(Worker).where(old))
