"""FastAPI dependencies: the creature that a path names."""

import json
from typing import Annotated

from fastapi import Depends, Path
from sqlalchemy.orm import Session

from ..auth.authorize import ShareAccess, ShareAccessDep
from ..services.services import ServicesDep
from ..tables import Creature, find

Sha = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


def find_creature(session: Session, sha: str, share: ShareAccess | None = None) -> Creature:
    """Return the row; raise `DomainError` where it is missing or not in the share."""
    if share:
        share.refuse_unless_holds(session, sha)
    return find(session, Creature, sha, "name")


def creature(sha: Sha, services: ServicesDep, share: ShareAccessDep) -> Creature:
    """Return the row, read over a connection that is closed again: the store may be slow."""
    with services.sessions.read() as session:
        return find_creature(session, sha, share)


def identity(sha: Sha, services: ServicesDep, share: ShareAccessDep) -> bytes:
    """Return the identity of a creature, read as `creature`."""
    with services.sessions.read() as session:
        return find_creature(session, sha, share).identity


def identity_and_measures(sha: Sha, services: ServicesDep, share: ShareAccessDep) -> bytes:
    """Return JSON of a creature's `identity` and of what it `measured`, read as `creature`."""
    with services.sessions.read() as session:
        row = find_creature(session, sha, share)
        measured = json.dumps(row.measured).encode()
        return b'{"identity":%b,"measured":%b}' % (row.identity, measured)


CreatureDep = Annotated[Creature, Depends(creature)]
IdentityDep = Annotated[bytes, Depends(identity)]
MeasuredDep = Annotated[bytes, Depends(identity_and_measures)]
