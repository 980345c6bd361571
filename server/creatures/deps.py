"""FastAPI dependencies: the creature that a path names."""

from typing import Annotated

from fastapi import Depends, Path
from sqlalchemy.orm import Session

from ..auth.authorize import ShareAccess, ShareAccessDep
from ..core.errors import ProblemError
from ..services.services import ServicesDep, SessionDep
from ..tables import Creature

Sha = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


def find_creature(session: Session, sha: str, share: ShareAccess | None = None) -> Creature:
    """Return the row; raise `ProblemError` where it is missing or not in the share."""
    if share:
        share.refuse_unless_holds(session, sha)
    found = session.get(Creature, sha)
    if found is None:
        raise ProblemError(404, "Not found", f"No creature has the name {sha}.")
    return found


def creature(sha: Sha, session: SessionDep, share: ShareAccessDep) -> Creature:
    return find_creature(session, sha, share)


def identity(sha: Sha, services: ServicesDep, share: ShareAccessDep) -> bytes:
    """Return the identity of a creature, read over a connection that is closed again."""
    with services.sessions.read() as session:
        return find_creature(session, sha, share).identity


CreatureDep = Annotated[Creature, Depends(creature)]
IdentityDep = Annotated[bytes, Depends(identity)]
