"""FastAPI dependencies: the services, and a database session to read with."""

from collections.abc import Iterator
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from .services import Services


def services(request: Request) -> Services:
    return request.app.state.services


ServicesDep = Annotated[Services, Depends(services)]


def session(services: ServicesDep) -> Iterator[Session]:
    with services.sessions.read() as session:
        yield session


# Closed before the answer is sent: a long download must not hold a connection.
SessionDep = Annotated[Session, Depends(session, scope="function")]
