"""Tokens: made, shown, revoked, and who holds one."""

from .book import (
    PREFIX,
    Made,
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
    "FILE",
    "PREFIX",
    "Made",
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
