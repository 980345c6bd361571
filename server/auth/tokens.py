"""The table of tokens. Of a secret only its hash is kept, which nobody can turn back."""

import secrets
from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256
from typing import cast
from uuid import UUID

from sqlalchemy import ColumnElement, func, or_, select, update
from sqlalchemy.exc import IntegrityError, OperationalError
from sqlalchemy.orm import Session

from ..core.database import clock
from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..services.services import Services
from ..tables import Token
from .principal import ADMIN, Principal, Scope

PREFIX = "mc_"
"""Begins every secret, so that people and scanners of leaks know it for what it is."""
BYTES = 32
SHOWN = len(PREFIX) + 6
"""Characters of a secret that are kept, by which its holder can tell which one it is."""
COARSE = timedelta(minutes=5)
"""When a token was last used is written down no more often."""
CHALLENGE = {"WWW-Authenticate": "Bearer"}


class Wrong(ProblemError):
    """What was sent is no token of this server's, and never was: somebody may be guessing."""

    def __init__(self) -> None:
        detail = "The token that was sent is none of this server's."
        super().__init__(401, "Unauthorized", detail, headers=CHALLENGE)


@dataclass(frozen=True)
class Made:
    """A new token and its secret, which is known now and never again."""

    token: Token
    secret: str


def hashed(secret: str) -> str:
    """What is kept of a secret. Its 256 random bits need no salt and no slow hash."""
    return sha256(secret.encode(errors="surrogatepass")).hexdigest()


def create(
    services: Services, name: str, scope: Scope, expires_at: datetime | None = None
) -> Made:
    """Make a token; `ProblemError` where a live one has the name."""
    secret = PREFIX + secrets.token_urlsafe(BYTES)
    try:
        with services.sessions.write.begin() as session:
            now = _now(session)
            _refuse_past(expires_at, now)
            # One that has expired gives up its name.
            over = (Token.name == name, Token.revoked_at.is_(None), Token.expires_at <= now)
            session.execute(update(Token).where(*over).values(revoked_at=Token.expires_at))
            token = Token(
                name=name,
                secret_sha256=hashed(secret),
                beginning=secret[:SHOWN],
                scope=scope,
                expires_at=expires_at,
            )
            session.add(token)
            session.flush()
    except IntegrityError:
        detail = f"A token named {name!r} is there already; revoke it, or take another name."
        raise ProblemError(409, "Name taken", detail) from None
    return Made(token, secret)


def _refuse_past(expires_at: datetime | None, now: datetime) -> None:
    if expires_at is not None and expires_at <= now:
        needed = f"a moment after now, {now:%Y-%m-%d %H:%M} UTC"
        message = f"needs {needed}; got {expires_at.isoformat()}"
        error = FieldError(
            field="expires_at", message=message, needed=needed, got=expires_at.isoformat()
        )
        raise ProblemError(422, "Invalid input", f"expires_at: {message}", [error])


def holder(services: Services, secret: str) -> Principal:
    """Return the principal of a secret; raise `Wrong` or `ProblemError` where there is none."""
    with services.sessions.read() as session:
        now = _now(session)
        mine = select(Token).where(Token.secret_sha256 == hashed(secret))
        token = session.scalars(mine).one_or_none()
    if token is None:
        raise Wrong()
    if token.revoked_at is not None:
        raise _over(f"The token `{token.name}` was revoked.")
    if token.expires_at is not None and token.expires_at <= now:
        raise _over(
            f"The token `{token.name}` expired at {token.expires_at:%Y-%m-%d %H:%M} UTC."
        )
    if token.last_used_at is None or now - token.last_used_at > COARSE:
        _note_use(services, token.id)
    return Principal(token.name, cast(Scope, token.scope), token.id, token.expires_at)


def _note_use(services: Services, token: UUID) -> None:
    """Nobody is refused because a busy database had no time for this."""
    used = update(Token).where(Token.id == token).values(last_used_at=clock())
    with suppress(OperationalError), services.sessions.write.begin() as session:
        session.execute(used)


def _over(detail: str) -> ProblemError:
    return ProblemError(401, "Unauthorized", detail, headers=CHALLENGE)


def known(session: Session) -> Sequence[Token]:
    """All tokens, those that were revoked too, newest first."""
    return session.scalars(select(Token).order_by(Token.created_at.desc(), Token.id)).all()


def live(session: Session, tokens: Collection[UUID]) -> set[UUID]:
    """Those of some tokens that are neither revoked nor expired."""
    return set(session.scalars(select(Token.id).where(Token.id.in_(tokens), *_live())))


def has_admin(session: Session, but: UUID | None = None) -> bool:
    """Whether anybody holds a live token of an admin, one token left aside."""
    others = select(func.count()).where(Token.scope == ADMIN, Token.id != but, *_live())
    return session.execute(others).scalar_one() > 0


def revoke(services: Services, token: UUID, last: bool = False) -> Token:
    """End a token now. `ProblemError` for the `last` of an admin, unless that may go too."""
    with services.sessions.write.begin() as session:
        found = session.get(Token, token)
        if found is None:
            raise ProblemError(404, "Not found", f"No token has the id {token}.")
        if found.revoked_at is None:
            if not last:
                _refuse_last(services, session, found)
            now = _now(session)
            expired = found.expires_at is not None and found.expires_at <= now
            found.revoked_at = found.expires_at if expired else now
    return found


def _refuse_last(services: Services, session: Session, token: Token) -> None:
    settings = services.settings
    if token.scope != ADMIN or not settings.needs_token or settings.token:
        return
    if not has_admin(session, token.id):
        detail = (
            f"`{token.name}` is the only token of an admin, without which nobody could make "
            "others: make another one first."
        )
        raise ProblemError(409, "The last admin", detail)


def _live() -> tuple[ColumnElement[bool], ...]:
    return Token.revoked_at.is_(None), or_(
        Token.expires_at.is_(None), Token.expires_at > clock()
    )


def _now(session: Session) -> datetime:
    return session.execute(select(clock())).scalar_one()
