"""Watching a run or a sweep until it has ended; Ctrl-C leaves it going."""

from collections.abc import Iterator

from .connection import Connection
from .polling import Standing, follow, follow_sweep
from .views import View, fitting


def watch(connection: Connection, run: str, view: View | None = None) -> str:
    """The state in which a run has ended. `KeyboardInterrupt` is passed on."""
    return _shown(follow(connection, run), f"Run {run}", view)


def watch_sweep(connection: Connection, sweep: str, view: View | None = None) -> str:
    """The same for a sweep."""
    return _shown(follow_sweep(connection, sweep), f"Sweep {sweep}", view)


def _shown(standings: Iterator[Standing], what: str, view: View | None) -> str:
    status = ""
    try:
        with view or fitting() as shown:
            for standing in standings:
                shown.show(standing)
                status = standing.record["status"]
    except KeyboardInterrupt:
        again = f"microcosmos watch {what.rpartition(' ')[2][:8]}"
        print(f"{what} goes on without being watched; to watch it again: {again}", flush=True)
        raise
    return status
