"""Files to delete: marked in the transaction that forgets them, and deleted later.

The server alone deletes files, so that a backup can make it wait.
"""

import logging
from collections.abc import Sequence

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..core.database import Sessions, clock, insert_missing
from ..tables import GarbageFile, InstallationState
from .artifacts import Artifacts

FILES_PER_STEP = 500

log = logging.getLogger(__name__)


def discard(session: Session, paths: Sequence[str]) -> None:
    """Mark files for deletion after this transaction."""
    insert_missing(session, GarbageFile, [{"path": path} for path in paths])


def remove_files(sessions: Sessions, artifacts: Artifacts) -> bool:
    """Delete a few marked files; return False if none were deleted."""
    with sessions.read() as session:
        kept = select(InstallationState.id).where(InstallationState.keep_files_until > clock())
        if session.scalars(kept).one_or_none():
            return False
        paths = list(session.scalars(select(GarbageFile.path).limit(FILES_PER_STEP)))
    removed = []
    for path in paths:
        try:
            artifacts.delete(path)
            removed.append(path)
        except OSError as error:
            log.warning("will remove %s again: %s", path, error)
    if removed:
        with sessions.write.begin() as session:
            session.execute(delete(GarbageFile).where(GarbageFile.path.in_(removed)))
    return bool(removed)
