"""The first token, created where others can reach the server and no token exists."""

import os

from sqlalchemy import delete, exists, select

from ..core.errors import DomainError
from ..services.services import Services
from ..settings import Settings, create_private
from ..tables import Token
from .principal import ADMIN
from .tokens import create, has_admin

NAME = "admin"
FILE = "admin-token"


def create_first_token(services: Services) -> str | None:
    """Create an admin token, write its secret to the data folder and return it.

    Return None if no token is needed or one exists. Raise `ValueError` if its file cannot be
    written, or if tokens exist but no live admin token: a new one at each start would undo the
    revocation of the last one.
    """
    settings = services.settings
    if not settings.needs_admin_token:
        return None
    with services.sessions.read() as session:
        exist = session.scalar(select(exists().select_from(Token)))
    if exist:
        refuse_without_admin(services)
        return None
    try:
        made = create(services, NAME, ADMIN)
    except DomainError:  # Another server, started at the same time, was faster.
        return None
    path = settings.data / FILE
    try:
        create_private(settings.data)
        # Removed and made anew: nobody else can have opened the file, or put a link there.
        path.unlink(missing_ok=True)
        with os.fdopen(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w") as file:
            file.write(made.secret + "\n")
    except OSError as error:
        # Nobody knows its secret: the next start makes another one.
        with services.sessions.write.begin() as session:
            session.execute(delete(Token).where(Token.id == made.token.id))
        needed = "A file for the first admin token must be writable"
        raise ValueError(f"{needed}; got {path} ({error.strerror})") from error
    return made.secret


def announcement(settings: Settings, secret: str) -> str:
    file = settings.data.resolve() / FILE
    return (
        f"{secret} is the admin token. It is shown once and kept in {file}. Sign in with it at "
        "/settings, where you can create more tokens."
    )


def refuse_without_admin(services: Services) -> None:
    """Raise `ValueError` if tokens are needed and no live admin token exists."""
    if not services.settings.needs_admin_token:
        return
    with services.sessions.read() as session:
        found = has_admin(session)
    if not found:
        raise ValueError(
            "A server that others can reach needs an admin token, and there is none: "
            "create one with `python -m microcosmos_server.auth create NAME --scope admin`, "
            "or set MICROCOSMOS_TOKEN"
        )
