"""Wire types of tokens and principals."""

from datetime import datetime
from typing import Annotated
from uuid import UUID

from pydantic import AwareDatetime, Field, StringConstraints

from ..core.schemas import Wire
from .principal import Scope


class Quota(Wire):
    """Limits on the runs of a token; None: without limit."""

    max_queued: Annotated[int, Field(ge=0, le=1_000_000)] | None = None
    max_running: Annotated[int, Field(ge=0, le=10_000)] | None = None
    device_hours: Annotated[float, Field(ge=0.0, le=1e9)] | None = None
    """Hours of devices in 30 days. Runs that have begun go on; no further one starts."""


class TokenCreate(Quota):
    """Name, scope, end and quota of a new token."""

    name: Annotated[
        str,
        StringConstraints(
            strip_whitespace=True, min_length=1, max_length=64, pattern=r"^[^\x00]*$"
        ),
    ]
    scope: Scope
    expires_at: AwareDatetime | None = None
    """Without it the token never expires."""


class TokenRead(Quota):
    """A token without its secret."""

    id: UUID
    name: str
    prefix: str
    scope: Scope
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None
    """Accurate to five minutes."""
    used_hours: float = 0.0
    """Hours of devices that its runs have had in 30 days."""


class TokenCreated(TokenRead):
    secret: str
    """Only the answer to the request that creates the token contains it."""


class PrincipalRead(Wire):
    """The principal of the request."""

    name: str
    scope: Scope
    token: UUID | None
    """None for the user of this machine and for the token that the environment sets."""
    expires_at: datetime | None
    needed: bool
    """This server needs a token."""


class SignIn(Wire):
    token: Annotated[
        str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)
    ]
