"""Tokens: made, shown, revoked, and who holds one."""

from .book import (
    CHALLENGE,
    PREFIX,
    Made,
    Wrong,
    create,
    has_admin,
    hashed,
    holder,
    known,
    live,
    revoke,
)
from .first import FILE, begin, refuse_without_admin, told

__all__ = [
    "CHALLENGE",
    "FILE",
    "PREFIX",
    "Made",
    "Wrong",
    "begin",
    "create",
    "has_admin",
    "hashed",
    "holder",
    "known",
    "live",
    "refuse_without_admin",
    "revoke",
    "told",
]
