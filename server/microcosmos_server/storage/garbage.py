"""Files to delete: marked in the transaction that forgets them, and deleted later.

The server alone deletes files, so that a backup can make it wait.
"""

import logging
from collections.abc import Sequence
from datetime import datetime, timedelta

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from ..core.database import Sessions, clock, insert_or_update, now
from ..tables import Artifact, GarbageFile, InstallationState
from . import mark
from .artifacts import Artifacts

FILES_PER_STEP = 20
WRITING = timedelta(hours=1)
"""Longer than any process takes to write a file and the row that names it."""

log = logging.getLogger(__name__)


def discard(session: Session, paths: Sequence[str]) -> None:
    """Mark files for deletion after this transaction."""
    if paths:
        _mark(session, paths, now(session))


def begin_file(sessions: Sessions, path: str) -> None:
    """Mark a file that will be written before its row: without that row it is deleted.

    Nobody else would find it after a crash or an outage of the database in between.
    """
    with sessions.write.begin() as session:
        _mark(session, [path], now(session) + WRITING)


def _mark(session: Session, paths: Sequence[str], due: datetime) -> None:
    rows = [{"path": path, "due_at": due} for path in paths]
    insert_or_update(session, GarbageFile, rows, ["path"], {"due_at": due})


def keep_file(session: Session, path: str) -> None:
    """Take the mark of a file back, in the transaction that inserts its row."""
    session.execute(delete(GarbageFile).where(GarbageFile.path == path))


def remove_files(sessions: Sessions, artifacts: Artifacts) -> bool:
    """Delete a few marked files; return False if none were deleted."""
    with sessions.read() as session:
        # A backup copies the files that its copy of the database names, also those forgotten
        # since.
        kept = select(InstallationState.id).where(InstallationState.keep_files_until > clock())
        if session.scalars(kept).one_or_none():
            return False
        # The name of a share's file is used again: another process may have written it whole.
        named = select(Artifact.path).where(Artifact.path == GarbageFile.path).exists()
        due = select(GarbageFile.path).where(GarbageFile.due_at <= clock(), ~named)
        order = (GarbageFile.due_at, GarbageFile.path)
        paths = list(session.scalars(due.order_by(*order).limit(FILES_PER_STEP)))
    # Behind a lost mount every file seems gone, and nothing would name them later.
    if not paths or mark.fault(sessions, artifacts):
        return False
    removed: list[str] = []
    failed: list[str] = []
    for path in paths:
        try:
            artifacts.delete(path)
            removed.append(path)
        except OSError as error:
            log.warning("cannot remove %s, will try again: %s", path, error)
            failed.append(path)
            if not artifacts.local:
                break  # Each of the others would wait for the store as long.
    with sessions.write.begin() as session:
        session.execute(delete(GarbageFile).where(GarbageFile.path.in_(removed)))
        late = update(GarbageFile).where(GarbageFile.path.in_(failed))
        session.execute(late.values(due_at=clock()))
    return bool(removed)
