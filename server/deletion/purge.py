"""Purge runs whose time in the bin is over, with everything that only they use.

Each step is a small transaction, and the database holds the remaining work: a pass may stop
anywhere, and the next one continues.
"""

import logging
from typing import Any
from uuid import UUID

from sqlalchemy import delete, inspect, select, tuple_, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from ..core.database import clock
from ..creatures.storage import creatures_of, mark_garbage
from ..runs.lifecycle import change
from ..services.services import Services
from ..storage import garbage as files
from ..storage.artifacts import run_folder
from ..storage.garbage import discard
from ..tables import (
    Artifact,
    Choice,
    Elite,
    Generation,
    Idempotency,
    InitialCreature,
    LogEntry,
    Notification,
    Result,
    Run,
    Share,
)
from .garbage import collect

STEPS = 200
"""Limit on the transactions in one pass, since the reconciler has other work too."""
ROWS_PER_TRANSACTION = 500

log = logging.getLogger(__name__)


def purge(services: Services, steps: int = STEPS) -> None:
    for step in (purge_rows, collect_creatures, remove_files):
        while steps and step(services):
            steps -= 1


def purge_rows(services: Services) -> bool:
    """Delete a few rows of a run, finally the run itself; return False if none is due."""
    with services.sessions.write.begin() as session:
        due = (Run.purge_at.is_not(None), Run.purge_at <= clock())
        run_id = session.scalars(select(Run.id).where(*due).limit(1)).one_or_none()
        # This locks the row: a restore either came before or fails.
        run = run_id and change(session, run_id, *due, purge_at=Run.purge_at)
        if not run:
            return run_id is not None
        tables = (Elite, Result, Generation, LogEntry)
        gone = not any(_delete_some(session, run.id, table) for table in tables)
        if gone:
            _delete_run(session, run.id)
    if gone:
        services.events.publish("purge", run.id, {"run": str(run.id)})
        log.info("run %s is purged", run.id)
    return True


def collect_creatures(services: Services) -> bool:
    """Delete a few creatures of purged runs; return False if none are left to check."""
    try:
        with services.sessions.write.begin() as session:
            return collect(session)
    except IntegrityError as error:  # One has come into use meanwhile.
        log.info("will collect again: %s", error)
        return False


def remove_files(services: Services) -> bool:
    return files.remove_files(services.sessions, services.artifacts)


def _delete_some(session: Session, run_id: UUID, table: Any) -> bool:
    """Delete a few rows and mark their creatures; return False if there were none."""
    keys = inspect(table).primary_key
    rows = select(*keys).where(table.run_id == run_id).limit(ROWS_PER_TRANSACTION)
    chosen = [tuple(row) for row in session.execute(rows)]
    if not chosen:
        return False
    mine = tuple_(*keys).in_(chosen)
    if table in (Elite, Result):
        mark_garbage(session, run_id, creatures_of(table).where(mine))
    session.execute(delete(table).where(mine))
    return True


def _delete_run(session: Session, run_id: UUID) -> None:
    mark_garbage(
        session,
        run_id,
        select(InitialCreature.creature).where(InitialCreature.run_id == run_id),
        select(Choice.creature).where(Choice.run_id == run_id),
    )
    rows = delete(Artifact).where(Artifact.run_id == run_id).returning(Artifact.path)
    folder = run_folder(run_id)
    elsewhere = [path for path in session.scalars(rows) if not path.startswith(folder)]
    discard(session, [folder, *elsewhere])
    for table in (InitialCreature, Choice, Idempotency, Notification, Share):
        session.execute(delete(table).where(table.run_id == run_id))
    session.execute(update(Run).where(Run.forked_from == run_id).values(forked_from=None))
    session.execute(delete(Run).where(Run.id == run_id))
