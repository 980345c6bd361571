"""Mends what deaths and outages leave: runs without a worker, runs without a job.

The server does it every few seconds; Redis may be emptied at any time without losing a run.
"""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from uuid import UUID

from redis import RedisError
from sqlalchemy import delete, select
from sqlalchemy.exc import SQLAlchemyError

from ..core.database import ago
from ..deletion.purge import purge
from ..estimates.position import in_line
from ..runs.lifecycle import announce, hand_back, lost, release, yield_up
from ..runs.log import note
from ..services.services import Services
from ..tables import CANCELLED, QUEUED, RUNNING, Run, Sweep, Worker

FORGOTTEN_AFTER = 3600.0
"""Seconds after which a silent worker is no longer remembered."""

log = logging.getLogger(__name__)


@contextmanager
def reconciling(services: Services) -> Iterator[None]:
    """Reconcile now and every few seconds, in a thread, until the end of the block."""
    ended = Event()

    def repeat() -> None:
        while True:
            try:
                reconcile(services)
            except (RedisError, SQLAlchemyError) as error:
                log.warning("will reconcile again: %s", error)  # An outage ends by itself.
            except Exception:  # Without this thread a lost run would be lost for good.
                log.exception("will reconcile again")
            if ended.wait(services.settings.reconcile_interval):
                return

    thread = Thread(target=repeat, name="reconciler", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def reconcile(services: Services) -> None:
    """One pass."""
    end_disobedient(services)
    take_back_lost(services)
    services.jobs.clean()
    enqueue_missing(services)
    forget_workers(services)
    purge(services)
    forget_empty_sweeps(services)


def end_disobedient(services: Services) -> None:
    """Cancel runs whose workers were asked to and did not; their heartbeats notice and kill."""
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
            ended = yield_up(session, run_id, *overdue)
            if ended:
                text = f"Cancelled: its worker did not stop within {grace:g} s."
                note(session, ended, text, "warning")
        if ended:
            announce(services, run_id)


def take_back_lost(services: Services) -> None:
    """Queue runs again whose worker has been silent for as long as a lease."""
    lease = services.settings.lease
    with services.sessions.read() as session:
        silent = (Run.status == RUNNING, lost(session, lease))
        found = session.execute(select(Run.id, Run.worker).where(*silent)).all()
    for run_id, worker in found:
        with services.sessions.write.begin() as session:
            error = f"no word from worker {worker} for {lease:g} s"
            run = release(session, run_id, *silent, error=error)
        if run:
            announce(services, run_id)
            _enqueue(services, run)


def enqueue_missing(services: Services) -> None:
    """Enqueue runs that wait and have no job, in the order in which they came."""
    with services.sessions.read() as session:
        line = in_line(session)
    at_hand = services.jobs.runs_at_hand() if line else set()
    for one in line:
        if str(one.run) not in at_hand:
            services.jobs.evolve(*one)


def forget_empty_sweeps(services: Services) -> None:
    """A sweep ends with the last of its runs."""
    alone = ~select(Run.id).where(Run.sweep == Sweep.id).exists()
    with services.sessions.read() as session:
        found = session.scalars(select(Sweep.id).where(alone)).all()
    if found:
        with services.sessions.write.begin() as session:
            session.execute(delete(Sweep).where(Sweep.id.in_(found), alone))


def forget_workers(services: Services) -> None:
    with services.sessions.write.begin() as session:
        old = Worker.heartbeat_at < ago(session, FORGOTTEN_AFTER)
        session.execute(delete(Worker).where(old))


def job_died(services: Services, run_id: UUID, worker: str, error: str) -> None:
    """A job process ended without a word: its run waits for another attempt at once."""
    with services.sessions.write.begin() as session:
        run = release(session, run_id, Run.worker == worker, error=error)
    if run:
        announce(services, run_id)
    requeue(services, run_id)


def job_stopped(services: Services, run_id: UUID, worker: str) -> None:
    """A job was killed because its worker had to stop: its run waits, without a mark."""
    with services.sessions.write.begin() as session:
        run = hand_back(session, run_id, Run.worker == worker)
    if run:
        announce(services, run_id)
    requeue(services, run_id)


def requeue(services: Services, run_id: UUID) -> None:
    """Enqueue a run if it waits; where Redis does not answer, the next pass does it."""
    with services.sessions.read() as session:
        run = session.get(Run, run_id)
    if run:
        _enqueue(services, run)


def _enqueue(services: Services, run: Run) -> None:
    if run.status != QUEUED:
        return
    try:
        services.jobs.evolve(run.id, run.sweep is not None, run.plugin_versions)
    except RedisError as error:
        log.warning("run %s stays queued until Redis answers: %s", run.id, error)
