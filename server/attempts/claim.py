"""Claim a run: start an attempt, and record its failure on the run."""

import logging
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from uuid import UUID

from sqlalchemy import func, or_

from ..core.database import clock
from ..runs import log
from ..runs.announce import announce
from ..runs.lifecycle import change, fail_attempt
from ..services.services import Services
from ..tables import OVERRIDE_ALLOWED, QUEUED, RUNNING, Run, Worker
from ..workers import plugins
from .attempt import Attempt, ClaimLost
from .checkpoints import CheckpointUnavailable, rewind
from .leases import lease_expired

OUTAGE_SECONDS = 600.0
"""Seconds that a computed generation waits while the database is away."""

logger = logging.getLogger(__name__)


def claim(services: Services, run_id: UUID, worker: str) -> Attempt | None:
    """Start an attempt at a queued run; None if this worker cannot have the run.

    A run that this worker already had, or whose lease has expired, counts as queued. Rows that
    were recorded after its checkpoint are deleted.
    """
    with services.sessions.write.begin() as session:
        run = session.get(Run, run_id)
        if run and not plugins.has_versions(session.get(Worker, worker), run.plugin_versions):
            return None  # The run waits in another queue.
        over = or_(Run.worker == worker, lease_expired(session, services.settings.lease))
        fail_attempt(session, run_id, over, error="the worker stopped reporting")
        started = {
            "status": RUNNING,
            "attempt": Run.attempt + 1,
            "attempts_without_checkpoint": Run.attempts_without_checkpoint + 1,
            "worker": worker,
            "heartbeat_at": clock(),
            "started_at": func.coalesce(Run.started_at, clock()),
        }
        run = change(session, run_id, Run.status == QUEUED, **started)
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
                other_device=run.device_override == OVERRIDE_ALLOWED,
            )
    if run and rewound:
        attempt.publish_rewind()
    announce(services, run_id)
    return attempt if run else None


@contextmanager
def claimed(
    services: Services, run_id: UUID, worker: str, stop_requested: Callable[[], bool]
) -> Iterator[Attempt | None]:
    """Yield an attempt that waits while the database is away, or None if it cannot be claimed.

    An error inside is recorded on the run. An attempt that has lost its claim ends silently.
    """
    attempt = claim(services, run_id, worker)
    if attempt is None:
        yield None
        return
    attempt.stop_requested, attempt.outage_seconds = stop_requested, OUTAGE_SECONDS
    try:
        yield attempt
    except ClaimLost as error:
        logger.warning("Lost %s", error)
    except CheckpointUnavailable as error:
        logger.error("Run %s: %s", run_id, error)
        with suppress(ClaimLost):
            attempt.pause_until_resumed(str(error))
    except Exception:
        logger.exception("Run %s failed", run_id)
        with suppress(ClaimLost):
            attempt.fail(traceback.format_exc())
