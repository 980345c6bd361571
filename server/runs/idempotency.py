"""Requests that may be sent again: under one key, one run or one sweep."""

import json
from hashlib import sha256
from typing import Any

from sqlalchemy.orm import Session

from ..auth.principal import owner
from ..core.errors import Refused
from ..services.services import Services
from ..tables import Idempotency


def remember(session: Session, key: str | None, request: Any, **made: Any) -> None:
    """Have a key stand for what a request made: its `run_id`, or its `sweep`."""
    if key is not None:
        session.add(Idempotency(key=_own(key), body_sha256=digest(request), **made))
        session.flush()


def earlier(services: Services, key: str | None, request: Any) -> Idempotency | None:
    """What a key stands for already; `Refused` where another request came under it."""
    with services.sessions.read() as session:
        known = session.get(Idempotency, _own(key)) if key is not None else None
    if known and known.body_sha256 != digest(request):
        made = f"sweep {known.sweep}" if known.sweep else f"run {known.run_id}"
        detail = f"Idempotency-Key {key!r} was used with another request, for {made}."
        raise Refused(422, "Idempotency key reused", detail)
    return known


def digest(request: Any) -> str:
    """What two requests under one key must have in common.

    Canonical JSON would not do: specs may have whole numbers that it has not.
    """
    return sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()


def _own(key: str) -> str:
    """Whoever has a token has keys of their own: somebody else may have chosen the same."""
    mine = owner()
    return key if mine is None else sha256(f"{mine} {key}".encode()).hexdigest()
