"""Tokens, and who asks."""

from datetime import datetime
from typing import Annotated, Literal
from uuid import UUID

from pydantic import AwareDatetime, StringConstraints

from ..core.schemas import Wire

Scope = Literal["read", "write", "admin"]


class TokenCreate(Wire):
    """What a token is to be called, what it may, and until when."""

    name: Annotated[
        str,
        StringConstraints(
            strip_whitespace=True, min_length=1, max_length=64, pattern=r"^[^\x00]*$"
        ),
    ]
    scope: Scope
    expires_at: AwareDatetime | None = None
    """Never, if left out."""


class TokenRead(Wire):
    """A token without its secret, which nobody has but its holder."""

    id: UUID
    name: str
    prefix: str
    """The first characters of the secret, to tell which one it is."""
    scope: Scope
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None
    """About, within five minutes."""


class TokenMade(TokenRead):
    secret: str
    """Shown here and never again."""


class CallerRead(Wire):
    """Who asks, and what they may."""

    name: str
    scope: Scope
    token: UUID | None
    """None where it is this machine's own user, or the token that the environment names."""
    expires_at: datetime | None
    needed: bool
    """Whether this server asks for a token at all."""


class SignIn(Wire):
    token: Annotated[
        str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)
    ]
