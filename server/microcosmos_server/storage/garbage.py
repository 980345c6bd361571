"""Files to delete: marked in the transaction that forgets them, and deleted later.

The server alone deletes files, so that a backup can make it wait.
"""

import logging
from collections.abc import Sequence

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from ..core.database import Sessions, clock, insert_missing
from ..tables import GarbageFile, InstallationState
from .artifacts import Artifacts

FILES_PER_STEP = 20

log = logging.getLogger(__name__)


def discard(session: Session, paths: Sequence[str]) -> None:
    """Mark files for deletion after this transaction."""
    insert_missing(session, GarbageFile, [{"path": path} for path in paths])


def remove_files(sessions: Sessions, artifacts: Artifacts) -> bool:
    """Delete a few marked files; return False if none were deleted."""
    with sessions.read() as session:
        # A backup copies the files that its copy of the database names, also those forgotten
        # since.
        kept = select(InstallationState.id).where(InstallationState.keep_files_until > clock())
        if session.scalars(kept).one_or_none():
            return False
        order = (GarbageFile.failed_at.nulls_first(), GarbageFile.path)
        due = select(GarbageFile.path).order_by(*order).limit(FILES_PER_STEP)
        paths = list(session.scalars(due))
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
    if paths:
        with sessions.write.begin() as session:
            session.execute(delete(GarbageFile).where(GarbageFile.path.in_(removed)))
            late = update(GarbageFile).where(GarbageFile.path.in_(failed))
            session.execute(late.values(failed_at=clock()))
    return bool(removed)
