"""How an attempt at a run begins."""

from typing import Any
from uuid import UUID

from sqlalchemy import func, or_
from sqlalchemy.orm import Session

from ..core.database import clock
from ..runs import log
from ..runs.announce import announce
from ..runs.lifecycle import change, lost, release
from ..services.services import Services
from ..tables import OVERRIDE_ALLOWED, QUEUED, RUNNING, Run, Worker
from ..workers import plugins
from .checkpoints import rewind
from .claim import Claim, tell_rewind


def claim(services: Services, run_id: UUID, worker: str) -> Claim | None:
    """Begin an attempt at a queued run; None where there is nothing to do for this worker.

    A run that this very worker had, or whose worker is silent, counts as queued: its last
    attempt is over. What was written beyond the checkpoint is deleted.
    """
    with services.sessions.write.begin() as session:
        if not _fit(session, run_id, worker):  # Whoever has it finds it in another queue.
            return None
        over = or_(Run.worker == worker, lost(session, services.settings.lease))
        release(session, run_id, over, error="the worker ended without a word")
        run = change(session, run_id, Run.status == QUEUED, **_begun(worker))
        before = run.generation if run else 0
        rewound = run is not None and rewind(session, run)
        if run:
            log.note_beginning(session, run, before)
        begun = _begin(services, run) if run else None
    if rewound and begun:
        tell_rewind(begun)
    announce(services, run_id)
    return begun


def _fit(session: Session, run_id: UUID, worker: str) -> bool:
    """Whether a worker has what a run needs of users' own."""
    run = session.get(Run, run_id)
    return run is None or plugins.fit(session.get(Worker, worker), run.plugin_versions)


def _begun(worker: str) -> dict[str, Any]:
    return {
        "status": RUNNING,
        "attempt": Run.attempt + 1,
        "attempts_without_checkpoint": Run.attempts_without_checkpoint + 1,
        "worker": worker,
        "heartbeat_at": clock(),
        "started_at": func.coalesce(Run.started_at, clock()),
    }


def _begin(services: Services, run: Run) -> Claim:
    return Claim(
        services=services,
        run_id=run.id,
        attempt=run.attempt,
        spec=run.spec,
        generation=run.checkpoint_generation,
        seconds=run.seconds,
        other_device=run.device_override == OVERRIDE_ALLOWED,
    )
