"""Requests that may be sent again: under one key, one run or one sweep."""

import json
from hashlib import sha256
from typing import Any
from uuid import UUID

from sqlalchemy.orm import Session

from ..core.errors import ProblemError
from ..services.services import Services
from ..tables import Idempotency


def remember(
    session: Session, key: str | None, owner: UUID | None, request: Any, **made: Any
) -> None:
    """Have a key stand for what a request made: its `run_id`, or its `sweep`."""
    if key is not None:
        session.add(Idempotency(key=_key(owner, key), body_sha256=digest(request), **made))
        session.flush()


def earlier(
    services: Services, key: str | None, owner: UUID | None, request: Any
) -> Idempotency | None:
    """What a key stands for already; `ProblemError` where another request came under it."""
    with services.sessions.read() as session:
        known = session.get(Idempotency, _key(owner, key)) if key is not None else None
    if known and known.body_sha256 != digest(request):
        made = f"sweep {known.sweep}" if known.sweep else f"run {known.run_id}"
        detail = f"Idempotency-Key {key!r} was used with another request, for {made}."
        raise ProblemError(422, "Idempotency key reused", detail)
    return known


def digest(request: Any) -> str:
    """What two requests under one key must have in common.

    Canonical JSON would not do: specs may have whole numbers that it has not.
    """
    return sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()


def _key(owner: UUID | None, key: str) -> str:
    """Return the key as stored: owners do not share keys, since two may choose the same."""
    return key if owner is None else sha256(f"{owner} {key}".encode()).hexdigest()
