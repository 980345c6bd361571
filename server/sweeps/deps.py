"""FastAPI dependencies: the sweep that a path names."""

from typing import Annotated
from uuid import UUID

from fastapi import Depends
from sqlalchemy.orm import Session

from ..core.errors import ProblemError
from ..services.deps import SessionDep
from ..tables import Sweep


def find_sweep(session: Session, sweep_id: UUID) -> Sweep:
    found = session.get(Sweep, sweep_id)
    if found is None:
        raise ProblemError(404, "Not found", f"No sweep has the id {sweep_id}.")
    return found


def sweep(sweep_id: UUID, session: SessionDep) -> Sweep:
    return find_sweep(session, sweep_id)


SweepDep = Annotated[Sweep, Depends(sweep)]
