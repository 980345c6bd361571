"""FastAPI dependencies: the sweep that a path names."""

from typing import Annotated
from uuid import UUID

from fastapi import Depends
from sqlalchemy.orm import Session

from ..auth.authorize import Writer, authorize_owner
from ..core.errors import ProblemError
from ..services.services import ServicesDep, SessionDep
from ..tables import Sweep


def find_sweep(session: Session, sweep_id: UUID) -> Sweep:
    found = session.get(Sweep, sweep_id)
    if found is None:
        raise ProblemError(404, "Not found", f"No sweep has the id {sweep_id}.")
    return found


def sweep(sweep_id: UUID, session: SessionDep) -> Sweep:
    return find_sweep(session, sweep_id)


SweepDep = Annotated[Sweep, Depends(sweep)]


def own_sweep(sweep_id: UUID, principal: Writer, services: ServicesDep) -> UUID:
    """Return the id of a path; raise `ProblemError` if somebody else owns the sweep."""
    authorize_owner(services, principal, Sweep, sweep_id)
    return sweep_id


OwnSweepId = Annotated[UUID, Depends(own_sweep)]
