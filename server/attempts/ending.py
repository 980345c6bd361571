"""Columns of a run whose attempt ends."""

from typing import Any

from sqlalchemy import case

from ..core.database import clock
from ..tables import CANCELLED, PAUSED, Run


def ended(status: str) -> dict[str, Any]:
    return {
        "status": status,
        "finished_at": clock(),
        "requested_state": None,
        "requested_at": None,
    }


def paused() -> dict[str, Any]:
    """Return the values of a paused run, or of a cancelled one if that was requested."""
    return {
        "status": case((Run.requested_state == CANCELLED, CANCELLED), else_=PAUSED),
        "finished_at": case((Run.requested_state == CANCELLED, clock()), else_=None),
        "worker": None,
        "released_at": clock(),
        "requested_state": None,
        "requested_at": None,
    }
