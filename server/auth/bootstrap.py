"""The first token: made where others can reach the server and nobody could use it yet."""

import os
from pathlib import Path

from sqlalchemy import exists, select

from ..core.errors import ProblemError
from ..core.folders import private
from ..services.services import Services
from ..settings import Settings
from ..tables import Token
from .principal import ADMIN
from .tokens import create, has_admin

NAME = "admin"
FILE = "admin-token"


def begin(services: Services) -> str | None:
    """At the first start the token of an admin, its secret kept in the data folder too.

    None where no token is needed or one is there. Raises `ValueError` where tokens were made
    and none of an admin lives: a server that makes itself new ones could not be closed.
    """
    settings = services.settings
    if not settings.needs_token or settings.token:
        return None
    with services.sessions.read() as session:
        begun = session.scalar(select(exists().select_from(Token)))
    if begun:
        refuse_without_admin(services)
        return None
    try:
        made = create(services, NAME, ADMIN)
    except ProblemError:  # Another server, that started beside us, was first.
        return None
    _keep(settings.data / FILE, made.secret)
    return made.secret


def told(settings: Settings, secret: str) -> str:
    """The first token in words, for the terminal that started the server."""
    kept = settings.data.resolve() / FILE
    return (
        f"{secret} is the token of an admin, shown once and kept in {kept}. Sign in with it at "
        "/settings, where others can be made."
    )


def refuse_without_admin(services: Services) -> None:
    """Raise `ValueError` where tokens are needed and nobody holds one of an admin."""
    settings = services.settings
    if not settings.needs_token or settings.token:
        return
    with services.sessions.read() as session:
        found = has_admin(session)
    if not found:
        raise ValueError(
            "A server that others can reach needs the token of an admin, and none is live: "
            "make one with `python -m server.auth create NAME --scope admin`, or set "
            "MICROCOSMOS_TOKEN"
        )


def _keep(path: Path, secret: str) -> None:
    """Readable by nobody else, from the moment on at which it is there."""
    private(path.parent)
    path.unlink(missing_ok=True)
    with os.fdopen(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w") as file:
        file.write(secret + "\n")
