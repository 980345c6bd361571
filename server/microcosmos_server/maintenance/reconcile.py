"""The reconciler: repair runs that lack their worker, and delete expired rows.

A server runs it every few seconds; several servers take turns.
"""

import logging
import time
from contextlib import AbstractContextManager, suppress
from threading import Event
from typing import Any

from redis import RedisError
from sqlalchemy import case, delete, or_, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from ..attempts import leases
from ..attempts.preemption import make_room
from ..core.database import ago, clock
from ..deletion.purge import expire, purge
from ..runs.announce import announce
from ..runs.lifecycle import end_attempt, fail_attempt, release
from ..runs.log import note
from ..services.periodic import repeating
from ..services.services import Services
from ..tables import (
    CANCELLED,
    QUEUED,
    RUNNING,
    InstallationState,
    Notification,
    Run,
    Sweep,
    Worker,
)

SILENT_SECONDS = 3600.0
"""Seconds of silence after which a worker is deleted."""
EXPIRE_SECONDS = 3600.0
"""Seconds between two searches for expired data."""

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
            try:
                reconcile(services)
                if time.monotonic() >= expire_at:
                    expire(services)
                    expire_at = time.monotonic() + EXPIRE_SECONDS
                note_pass(services, time.monotonic() - began)
            finally:
                note_end(services)

    return repeating("reconciler", services.settings.reconcile_interval, take_pass)


def take_turn(services: Services) -> bool:
    """Return True unless another server began a pass within the interval."""
    settings, state = services.settings, InstallationState
    last = state.reconciled_at
    with services.sessions.write.begin() as session:
        if session.scalar(select(last > clock())):
            _catch_up(session)
        begun = ago(session, TURN * settings.reconcile_interval)
        # Workers renew a lease several times: within half of one they miss no more than that.
        pause = ago(session, max(settings.lease / 2, 2 * settings.reconcile_interval))
        since = case(
            (or_(last >= pause, state.seen_at >= pause), state.reachable_since),
            else_=clock(),
        )
        due = update(state).where(or_(last.is_(None), last <= begun, last > clock()))
        # One guarded UPDATE decides between servers: the second finds the new time.
        values = due.values(reconciled_at=clock(), reachable_since=since)
        return session.execute(values.returning(last)).one_or_none() is not None


TIMES = (
    *(InstallationState.seen_at, InstallationState.passed_at),
    *(InstallationState.reachable_since, Worker.heartbeat_at, Run.heartbeat_at),
    *(Run.requested_at, Run.released_at, Run.queued_at, Notification.due_at),
)
"""The times from which the server counts seconds, and by which runs wait their turn."""


def _catch_up(session: Session) -> None:
    """Let no time be ahead of the database's clock, which was set back: seconds count from now.

    Otherwise a worker that died would have its lease until the clock is where it was.
    """
    for one in TIMES:
        table: Any = one.class_
        session.execute(update(table).where(one > clock()).values({one.key: clock()}))


def was_reachable(session: Session, seconds: float) -> bool:
    """Return whether workers and people could reach the database for so long, as far as known.

    When an outage ends, all leases seem to have expired.
    """
    since = InstallationState.reachable_since
    long_enough = or_(since.is_(None), since <= ago(session, seconds))
    return session.scalar(select(InstallationState.id).where(long_enough)) is not None


def note_pass(services: Services, seconds: float) -> None:
    """Record a complete pass; an alert fires if none completes for long (deploy/prometheus)."""
    done = update(InstallationState).values(passed_at=clock(), pass_seconds=seconds)
    with services.sessions.write.begin() as session:
        session.execute(done)


def note_end(services: Services) -> None:
    """Record that the database is there, also after a pass that Redis or a store has ended."""
    with suppress(SQLAlchemyError), services.sessions.write.begin() as session:
        session.execute(update(InstallationState).values(seen_at=clock()))


def reconcile(services: Services) -> None:
    """Do all periodic work once."""
    cancel_overdue(services)
    requeue_expired(services)
    release_unclaimed(services)
    make_room(services)
    delete_silent_workers(services)
    purge(services)
    delete_empty_sweeps(services)
    # Without Redis a pass is complete all the same: it has an alert of its own.
    with suppress(RedisError):
        services.jobs.clean()


def cancel_overdue(services: Services) -> None:
    """Cancel runs whose workers did not stop in time. Their supervisors kill the jobs."""
    grace = services.settings.grace
    with services.sessions.read() as session:
        if not was_reachable(session, grace):
            return
        overdue = (
            Run.status == RUNNING,
            Run.requested_state == CANCELLED,
            Run.requested_at < ago(session, grace),
        )
        found = list(session.scalars(select(Run.id).where(*overdue)))
    for run_id in found:
        with services.sessions.write.begin() as session:
            # With the condition again: the worker may have stopped since the read.
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
        # The time first: a freeze after it makes no lease older.
        expired = (Run.status == RUNNING, leases.lease_expired(session, lease))
        if not was_reachable(session, lease):
            return
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
        if not was_reachable(session, services.settings.lease):
            return
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
