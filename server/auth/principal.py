"""Who asks: found by the guard, known to everything that a request does."""

from contextvars import ContextVar
from dataclasses import dataclass
from datetime import datetime
from typing import Literal
from uuid import UUID

Scope = Literal["read", "write", "admin"]
READ, WRITE, ADMIN = "read", "write", "admin"
RANKS = (READ, WRITE, ADMIN)
"""Each may what those before it may."""


@dataclass(frozen=True)
class Caller:
    """The holder of a token, or this machine's own user, who has none of the table's."""

    name: str
    scope: Scope
    token: UUID | None = None
    expires_at: datetime | None = None

    def may(self, scope: str) -> bool:
        return RANKS.index(self.scope) >= RANKS.index(scope)


LOCAL = Caller("local", ADMIN)
"""Everybody, where no token is needed; and all that is done without a request."""
SETTING = Caller("MICROCOSMOS_TOKEN", ADMIN)
"""Whoever has the token that the environment names."""
NOBODY = Caller("nobody", READ)
"""A stranger, who gets no further than what is public."""

CALLER: ContextVar[Caller] = ContextVar("caller", default=LOCAL)


def owner() -> UUID | None:
    """To whom belongs what is made now: a token, or nobody."""
    return CALLER.get().token
