"""Claim a run: start an attempt, and record its failure on the run."""

import logging
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from uuid import UUID

from sqlalchemy import func, or_
from sqlalchemy.exc import InterfaceError, OperationalError, ProgrammingError, TimeoutError

from ..core.database import clock, now
from ..core.errors import StoreUnavailable, first_line
from ..runs import log
from ..runs.announce import announce
from ..runs.lifecycle import change, fail_attempt
from ..schedule.fit import any_device
from ..services.services import Services
from ..tables import QUEUED, RUNNING, Run
from ..workers import totals
from .attempt import Attempt, ClaimLost
from .checkpoints import CheckpointUnavailable, rewind
from .leases import lease_expired

OUTAGE_SECONDS = 600.0
"""Seconds for which an attempt waits for a database or store that does not answer."""

logger = logging.getLogger(__name__)


UNUSABLE = (OperationalError, InterfaceError, ProgrammingError, TimeoutError)
"""Errors of a database that refuses connections, is away, or has other tables."""
TOO_LONG = ("57014", "55P03", "25P03", "25P04")
"""States of PostgreSQL that end what takes too long. That may be due to the run itself, which
would be tried for ever."""
UNCLAIMED = 75
"""Exit status of a process that could not use the database: EX_TEMPFAIL of sysexits.h."""


class Unclaimed(Exception):
    """A process could not use the database to claim its run."""


class NothingComputed(Exception):
    """An attempt failed before its first generation."""


def claim(services: Services, run_id: UUID, worker: str) -> Attempt | None:
    """Start an attempt at a queued run; None if this worker cannot have the run.

    A run that this worker already had, or whose lease has expired, counts as queued; one that
    another worker has taken does not. Rows that were recorded after its checkpoint are deleted.
    """
    with services.sessions.write.begin() as session:
        run = session.get(Run, run_id)
        other_device = run is not None and any_device(run, now(session))
        over = or_(Run.worker == worker, lease_expired(session, services.settings.lease))
        silent = "the worker stopped reporting"
        # The reconciler may not have passed since the lease expired, so the claim ends the old
        # attempt itself.
        fail_attempt(session, run_id, over, error=silent, reason="silence")
        started = {
            "status": RUNNING,
            "interrupted": False,
            "avoided_worker": None,
            "attempt": Run.attempt + 1,
            "attempts_without_checkpoint": Run.attempts_without_checkpoint + 1,
            "worker": worker,
            "heartbeat_at": clock(),
            "started_at": func.coalesce(Run.started_at, clock()),
        }
        free = or_(Run.worker.is_(None), Run.worker == worker)
        run = change(session, run_id, Run.status == QUEUED, free, **started)
        if run:
            before = run.generation
            rewound = rewind(session, run)
            log.note_start(session, run, before)
            attempt = Attempt(
                services=services,
                run_id=run.id,
                number=run.attempt,
                spec=run.spec,
                generation=run.checkpoint_generation,
                seconds=run.seconds,
                work=(run.evaluations, run.infeasible),
                other_device=other_device,
            )
            # Last: until the commit, others that count on this host wait for the row of the
            # total.
            totals.count(session, worker, totals.ATTEMPTS)
    if run and rewound:
        attempt.publish_rewind()
    announce(services, run_id)
    return attempt if run else None


@contextmanager
def claimed(
    services: Services, run_id: UUID, worker: str, stop_requested: Callable[[], bool]
) -> Iterator[Attempt | None]:
    """Yield an attempt that waits for the database and the store; None if it has no claim.

    An error inside is recorded on the run. An attempt that has lost its claim ends silently.
    Raise `NothingComputed` for an error before the first generation: its host may be broken.
    Raise `Unclaimed` where the database cannot be used, for which no run is to blame.
    """
    try:
        attempt = claim(services, run_id, worker)
    except UNUSABLE as error:
        if getattr(getattr(error, "orig", None), "sqlstate", None) in TOO_LONG:
            raise
        raise Unclaimed from error
    if attempt is None:
        yield None
        return
    attempt.stop_requested, attempt.outage_seconds = stop_requested, OUTAGE_SECONDS
    try:
        yield attempt
    except ClaimLost as error:
        logger.warning("Lost %s", error)
    except (CheckpointUnavailable, StoreUnavailable) as error:
        logger.error("Run %s: %s", run_id, error)
        with suppress(ClaimLost):
            _leave_unread(attempt, error)
    except Exception as error:
        logger.exception("Run %s failed", run_id)
        if not attempt.recorded:
            raise NothingComputed from error
        with suppress(ClaimLost):
            attempt.fail(first_line(error), traceback.format_exc())


def _leave_unread(attempt: Attempt, error: CheckpointUnavailable | StoreUnavailable) -> None:
    """End an attempt whose checkpoint cannot be read; it does not count.

    The run returns to the queue while the whole store is away: no worker takes it then. It
    pauses if only its own files are missing, damaged or unreadable.
    """
    missing = isinstance(error, CheckpointUnavailable)
    stops = not missing and attempt.interrupted()
    if stops or attempt.store_fault():  # A worker that has to stop does not wait for the store.
        attempt.requeue()
    else:
        unread = f"Its checkpoint cannot be read ({error}). Repair the store"
        attempt.pause_until_resumed(str(error) if missing else unread)
