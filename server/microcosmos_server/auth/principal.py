"""Principals: the senders of requests, with their scopes."""

from dataclasses import dataclass
from datetime import datetime
from typing import Literal
from uuid import UUID

from ..tables.installation import SCOPES

Scope = Literal["read", "write", "admin"]
Rank = Literal["share", "read", "write", "admin"]
"""The holder of a share may do less than any token allows."""
READ: Scope = "read"
WRITE: Scope = "write"
ADMIN: Scope = "admin"
SHARE: Rank = "share"
RANKS = (SHARE, *SCOPES)


@dataclass(frozen=True)
class Principal:
    """The holder of a token or of a share, or the user of this machine."""

    name: str
    scope: Rank
    token: UUID | None = None  # None without a row in the table of tokens.
    expires_at: datetime | None = None

    def may(self, scope: str) -> bool:
        return RANKS.index(self.scope) >= RANKS.index(scope)


LOCAL = Principal("local", ADMIN)
"""The user of this machine, where no token is needed."""
ENVIRONMENT = Principal("MICROCOSMOS_TOKEN", ADMIN)
SHARE_HOLDER = Principal("the holder of a share", SHARE)
