"""FastAPI dependencies: the run that a path names."""

from typing import Annotated
from uuid import UUID

from fastapi import Depends
from sqlalchemy.orm import Session

from ..auth.authorize import ShareAccessDep, Writer, authorize_owner
from ..core.errors import NotFound
from ..services.services import ServicesDep, SessionDep
from ..tables import Run, find


def find_run(session: Session, run_id: UUID, deleted: bool = False) -> Run:
    """Return the row; raise `DomainError` if it is missing, or in the bin unless `deleted`."""
    found = find(session, Run, run_id)
    if found.purge_at and not deleted:
        until = f"{found.purge_at:%Y-%m-%d %H:%M} UTC"
        detail = f"Run {run_id} is in the bin until {until}; restore it to use it again."
        raise NotFound(detail, title="In the bin")
    return found


def run(run_id: UUID, session: SessionDep, share: ShareAccessDep) -> Run:
    return share.run(session, run_id) if share else find_run(session, run_id)


def any_run(run_id: UUID, session: SessionDep, share: ShareAccessDep) -> Run:
    return share.run(session, run_id) if share else find_run(session, run_id, deleted=True)


RunDep = Annotated[Run, Depends(run)]
AnyRunDep = Annotated[Run, Depends(any_run)]
"""A run that may be in the bin."""


def own_run(run_id: UUID, principal: Writer, services: ServicesDep) -> UUID:
    """Return the id of a path; raise `DomainError` if somebody else owns the run."""
    authorize_owner(services, principal, Run, run_id)
    return run_id


OwnRunId = Annotated[UUID, Depends(own_run)]
