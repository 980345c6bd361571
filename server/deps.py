"""What routes ask for: the services, a session to read with, and the row that a path names."""

from collections.abc import Iterator
from datetime import datetime
from typing import Annotated
from uuid import UUID

from fastapi import Depends, Path, Request
from sqlalchemy.orm import Session

from .models import Creature, Run, Sweep
from .problems import Refused
from .services import Services


def services(request: Request) -> Services:
    return request.app.state.services


ServicesDep = Annotated[Services, Depends(services)]


def session(services: ServicesDep) -> Iterator[Session]:
    with services.sessions.read() as session:
        yield session


# Closed before the answer is sent: a long download must not hold a connection.
SessionDep = Annotated[Session, Depends(session, scope="function")]


def find_run(session: Session, run_id: UUID, deleted: bool = False) -> Run:
    """The row; one in the bin only where `deleted` ones will do."""
    found = session.get(Run, run_id)
    if found is None:
        raise Refused(404, "Not found", f"No run has the id {run_id}.")
    if found.purge_at and not deleted:
        raise Refused(404, "In the bin", in_the_bin(found.id, found.purge_at))
    return found


def in_the_bin(run_id: UUID, until: datetime) -> str:
    moment = f"{until:%Y-%m-%d %H:%M} UTC"
    return f"Run {run_id} is in the bin until {moment}; restore it to use it again."


def run(run_id: UUID, session: SessionDep) -> Run:
    return find_run(session, run_id)


Sha = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


def creature(sha: Sha, session: SessionDep) -> Creature:
    found = session.get(Creature, sha)
    if found is None:
        raise Refused(404, "Not found", f"No creature has the name {sha}.")
    return found


def find_sweep(session: Session, sweep_id: UUID) -> Sweep:
    found = session.get(Sweep, sweep_id)
    if found is None:
        raise Refused(404, "Not found", f"No sweep has the id {sweep_id}.")
    return found


def sweep(sweep_id: UUID, session: SessionDep) -> Sweep:
    return find_sweep(session, sweep_id)


def any_run(run_id: UUID, session: SessionDep) -> Run:
    return find_run(session, run_id, deleted=True)


RunDep = Annotated[Run, Depends(run)]
AnyRunDep = Annotated[Run, Depends(any_run)]
"""One in the bin too."""
SweepDep = Annotated[Sweep, Depends(sweep)]
CreatureDep = Annotated[Creature, Depends(creature)]
