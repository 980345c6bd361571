"""A map of a run's archive in a notebook, which follows the run."""

import time
from threading import Thread
from typing import TYPE_CHECKING, Any

from ..widgets import ArchiveMap
from . import formatting, polling
from .connection import Connection
from .errors import ServerError

if TYPE_CHECKING:
    from .run import Run

SECONDS = 2.0
"""Shortest time between two requests of the archive, in seconds."""


def live(run: "Run", connection: Connection, **options: Any) -> Any:
    """Return the map, and follow the run in a thread until it ends."""
    if "archive" not in run.spec:
        raise ValueError(f"a run with an archive is needed, got {run.experiment!r}")
    shown = ArchiveMap(run, **options)
    thread = Thread(target=_follow, args=(run, connection, shown), daemon=True)
    thread.start()
    return shown


def _follow(run: "Run", connection: Connection, shown: Any) -> None:
    generation, at = -1, float("-inf")
    try:
        for state in polling.follow(connection, run.id):
            record = state.record
            due = state.ended or time.monotonic() - at >= SECONDS
            if due and record["generation"] != generation:
                shown.show(run)
                generation, at = record["generation"], time.monotonic()
            shown.status = state.problem or _words(record)
    except ServerError as error:
        shown.status = str(error)


def _words(record: dict[str, Any]) -> str:
    parts = formatting.status_and_reason(record), formatting.done(record)
    return " · ".join(parts)
