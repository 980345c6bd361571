"""The table of tokens: create, look up, revoke, and watch for their end.

The table holds the hash of a secret, never the secret.
"""

import asyncio
import logging
import secrets
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256
from typing import Annotated, cast
from uuid import UUID

from pydantic import StringConstraints
from sqlalchemy import ColumnElement, func, select, update
from sqlalchemy.exc import IntegrityError, OperationalError, SQLAlchemyError
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..core.errors import Conflict, DomainError, Unauthorized
from ..services.services import Services
from ..tables import Token, find
from ..tables.base import refuse_past
from .principal import ADMIN, Principal, Scope

# People and secret scanners recognise a secret by its prefix.
PREFIX = "mc_"
SECRET_BYTES = 32
Name = Annotated[
    str,
    StringConstraints(
        strip_whitespace=True, min_length=1, max_length=64, pattern=r"^[^\x00]*$"
    ),
]
"""The name of a token: its owner or purpose."""
PREVIEW_LENGTH = len(PREFIX) + 6
"""Characters of a secret that the table keeps, so that its holder can recognise it."""
LAST_USED_INTERVAL = timedelta(minutes=5)
CHECK_SECONDS = 1.0
"""Longest time that an event stream outlives its token."""
CHALLENGE = {"WWW-Authenticate": "Bearer"}

log = logging.getLogger(__name__)


class UnknownToken(Unauthorized):
    """The token never existed here; somebody may be guessing."""

    def __init__(self) -> None:
        super().__init__("This server does not know the token.", headers=CHALLENGE)


@dataclass(frozen=True)
class NewToken:
    """A new token and its secret, which nobody can read later."""

    token: Token
    secret: str


def hashed(secret: str) -> str:
    """Return the hash of a secret. A secret of 256 random bits needs no salt or slow hash."""
    return sha256(secret.encode(errors="surrogatepass")).hexdigest()


def create(
    services: Services,
    name: str,
    scope: Scope,
    expires_at: datetime | None = None,
    **quota: float | None,
) -> NewToken:
    """Create a token; raise `DomainError` if a live token has the name."""
    secret = PREFIX + secrets.token_urlsafe(SECRET_BYTES)
    try:
        with services.sessions.write.begin() as session:
            refuse_past(session, expires_at)
            # An expired token frees its name.
            expired = (Token.name == name, Token.revoked_at.is_(None), ~Token.live())
            session.execute(update(Token).where(*expired).values(revoked_at=Token.expires_at))
            token = Token(
                name=name,
                secret_sha256=hashed(secret),
                prefix=secret[:PREVIEW_LENGTH],
                scope=scope,
                expires_at=expires_at,
                **quota,
            )
            session.add(token)
            session.flush()
    except IntegrityError:
        detail = (
            f"The name {name!r} is taken by a live token. Revoke it, or choose another name."
        )
        raise Conflict(detail, title="Name taken") from None
    return NewToken(token, secret)


def principal_of(services: Services, secret: str) -> Principal:
    """Return the holder of a token; raise `UnknownToken`, or `DomainError` if it has ended."""
    with services.sessions.read() as session:
        mine = select(Token).where(Token.secret_sha256 == hashed(secret))
        token = session.scalars(mine).one_or_none()
        if token is None:
            raise UnknownToken()
        if token.revoked_at is not None:
            raise _ended(f"The token `{token.name}` was revoked.")
        if token.expired(session):
            moment = f"{token.expires_at:%Y-%m-%d %H:%M} UTC"
            raise _ended(f"The token `{token.name}` expired at {moment}.")
        used = token.last_used_at
        stale = used is None or now(session) - used > LAST_USED_INTERVAL
    if stale:
        written = update(Token).where(Token.id == token.id).values(last_used_at=clock())
        # The database may be busy: the request does not wait for it.
        with suppress(OperationalError), services.sessions.write.begin() as session:
            session.execute(written)
    return Principal(token.name, cast(Scope, token.scope), token.id, token.expires_at)


def _ended(detail: str) -> DomainError:
    return Unauthorized(detail, headers=CHALLENGE)


def all_tokens(session: Session) -> Sequence[Token]:
    """Return all tokens, revoked ones too, newest first."""
    return session.scalars(select(Token).order_by(Token.created_at.desc(), Token.id)).all()


def has_admin(session: Session) -> bool:
    """Return whether a live admin token exists."""
    return bool(session.execute(select(func.count()).where(_live_admin())).scalar_one())


def _live_admin() -> ColumnElement[bool]:
    return (Token.scope == ADMIN) & Token.live()


def _outlasted(session: Session, token: Token) -> bool:
    """Return whether another live admin token lasts as long as one of them.

    Locks all of them: two that are revoked at once would each count on the other.
    """
    locked = select(Token).where(_live_admin()).order_by(Token.id).with_for_update()
    ends = [one.expires_at for one in session.scalars(locked) if one.id != token.id]
    end = token.expires_at
    return any(other is None or (end is not None and other >= end) for other in ends)


def revoke(services: Services, token: UUID, last: bool = False) -> Token:
    """End a token now; raise `DomainError` for the last admin token, unless `last`."""
    with services.sessions.write.begin() as session:
        found = find(session, Token, token)
        if found.revoked_at is None:
            is_admin = found.scope == ADMIN and services.settings.needs_admin_token
            if is_admin and not last and not _outlasted(session, found):
                detail = (
                    f"No other token of an admin lasts as long as `{found.name}`. Create "
                    "another admin token first, or nobody can create tokens."
                )
                raise Conflict(detail, title="The last admin")
            found.revoked_at = found.expires_at if found.expired(session) else now(session)
    return found


def change_quota(services: Services, token: UUID, quota: Mapping[str, float | None]) -> Token:
    """Change limits on the runs of a token."""
    with services.sessions.write.begin() as session:
        found = find(session, Token, token)
        for name, limit in quota.items():
            setattr(found, name, limit)
    services.wake.send()
    return found


def owner_names(session: Session, owners: Iterable[UUID | None]) -> dict[UUID | None, str]:
    """Return the names of owners, by id."""
    wanted = {owner for owner in owners if owner is not None}
    if not wanted:
        return {}
    rows = session.execute(select(Token.id, Token.name).where(Token.id.in_(wanted)))
    return {identifier: name for identifier, name in rows}


async def watch(
    services: Services,
    tokens: Callable[[], set[UUID]],
    end: Callable[[Collection[UUID]], None],
) -> None:
    """Call `end` with those of the `tokens` in use that have ended, until cancelled.

    One query each second serves all streams; without a stream there is none.
    """
    while True:
        await asyncio.sleep(CHECK_SECONDS)
        if used := tokens():
            try:
                valid = await asyncio.to_thread(_live, services, used)
            except SQLAlchemyError as error:
                log.warning("The tokens of event streams cannot be looked up: %s", error)
            else:
                end(used - valid)


def _live(services: Services, tokens: Collection[UUID]) -> set[UUID]:
    with services.sessions.read() as session:
        return set(session.scalars(select(Token.id).where(Token.id.in_(tokens), Token.live())))
