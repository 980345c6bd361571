"""Runs whose time in the bin is over go for good, with everything that is theirs alone.

Every step is a small transaction that leaves what is still to be done in the database: it may
end anywhere, and the next pass goes on.
"""

import logging
from collections.abc import Callable
from uuid import UUID

from sqlalchemy import ColumnElement, delete, inspect, select, tuple_, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from ..core.database import clock
from ..creatures.insertion import creatures_of, mark_garbage
from ..runs.lifecycle import change
from ..services.services import Services
from ..storage.artifacts import run_folder
from ..tables import (
    Artifact,
    Elite,
    GarbageFile,
    Generation,
    Idempotency,
    InitialCreature,
    LogEntry,
    Result,
    Run,
    Share,
)
from .garbage import collect, discard

STEPS = 200
"""Transactions in one pass: other things have to be mended too."""
AT_ONCE = 500
"""Rows that are deleted in one transaction."""

log = logging.getLogger(__name__)


def purge(services: Services, steps: int = STEPS) -> None:
    """One pass."""
    left = _carry_on(services, take_apart, steps)
    left = _carry_on(services, collect_some, left)
    _carry_on(services, remove_files, left)


def _carry_on(services: Services, step: Callable[[Services], bool], left: int) -> int:
    """Do a step as long as there is something to do: how many are left for others."""
    while left and step(services):
        left -= 1
    return left


def take_apart(services: Services) -> bool:
    """A few rows of a run whose time is over, at last the run itself; whether there is one."""
    with services.sessions.write.begin() as session:
        due = (Run.purge_at.is_not(None), Run.purge_at <= clock())
        run_id = session.scalars(select(Run.id).where(*due).limit(1)).one_or_none()
        # Held from here on: who restores it now comes too late, who did before was in time.
        run = run_id and change(session, run_id, *due, purge_at=Run.purge_at)
        if not run:
            return run_id is not None
        gone = not any(_some(session, run.id, table) for table in (Elite, Result))
        gone = gone and not any(
            _others(session, run.id, table) for table in (Generation, LogEntry)
        )
        if gone:
            _end(session, run.id)
    if gone:
        services.jobs.forget(str(run.id))
        services.events.publish("purge", run.id, {"run": str(run.id)})
        log.info("run %s is gone for good", run.id)
    return True


def collect_some(services: Services) -> bool:
    """A few creatures of runs that are gone; whether there were any to judge."""
    try:
        with services.sessions.write.begin() as session:
            return collect(session)
    except IntegrityError as error:  # Something has come to use one meanwhile.
        log.info("will judge again: %s", error)
        return False


def remove_files(services: Services) -> bool:
    """A few files that nothing names any more; whether any were removed."""
    with services.sessions.read() as session:
        paths = list(session.scalars(select(GarbageFile.path).limit(AT_ONCE)))
        known = select(Artifact.path).where(Artifact.path.in_(paths))
        made_again = set(session.scalars(known))
    removed = [path for path in paths if path in made_again or _removed(services, path)]
    with services.sessions.write.begin() as session:
        session.execute(delete(GarbageFile).where(GarbageFile.path.in_(removed)))
    return bool(removed)


def _removed(services: Services, path: str) -> bool:
    remove = (
        services.artifacts.delete_folder if path.endswith("/") else services.artifacts.delete
    )
    try:
        remove(path)
    except OSError as error:
        log.warning("will remove %s again: %s", path, error)
        return False
    return True


def _some(session: Session, run_id: UUID, table: type[Elite | Result]) -> bool:
    """Delete a few rows, remembering their creatures; whether there were any."""
    mine = _few(session, run_id, table)
    if mine is None:
        return False
    mark_garbage(session, run_id, creatures_of(table).where(mine))
    session.execute(delete(table).where(mine))
    return True


def _others(session: Session, run_id: UUID, table: type[Generation | LogEntry]) -> bool:
    """Delete a few rows of which nothing has to be remembered; whether there were any."""
    mine = _few(session, run_id, table)
    if mine is not None:
        session.execute(delete(table).where(mine))
    return mine is not None


def _few(
    session: Session, run_id: UUID, table: type[Elite | Result | Generation | LogEntry]
) -> ColumnElement[bool] | None:
    """The condition that is true of a few rows of a run; None where it has none."""
    keys = inspect(table).primary_key
    rows = select(*keys).where(table.run_id == run_id).limit(AT_ONCE)
    chosen = [tuple(row) for row in session.execute(rows)]
    return tuple_(*keys).in_(chosen) if chosen else None


def _end(session: Session, run_id: UUID) -> None:
    """The run itself, and what there are few of."""
    mark_garbage(
        session,
        run_id,
        select(InitialCreature.creature).where(InitialCreature.run_id == run_id),
    )
    files = delete(Artifact).where(Artifact.run_id == run_id).returning(Artifact.path)
    folder = run_folder(run_id)
    elsewhere = [path for path in session.scalars(files) if not path.startswith(folder)]
    discard(session, [folder, *elsewhere])
    for table in (InitialCreature, Idempotency, Share):
        session.execute(delete(table).where(table.run_id == run_id))
    session.execute(update(Run).where(Run.forked_from == run_id).values(forked_from=None))
    session.execute(delete(Run).where(Run.id == run_id))
