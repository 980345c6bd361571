"""Watching a run or a sweep until it has ended; Ctrl-C leaves it going."""

import time
from collections.abc import Iterator, Mapping
from typing import Any

from .connection import Connection
from .following import ENDED, POLL, Standing, follow
from .views import View, fitting

LEFT = "{} goes on without being watched; to watch it again: microcosmos watch {}"


def watch(connection: Connection, run: str, view: View | None = None) -> str:
    """The state in which a run has ended. `KeyboardInterrupt` is passed on."""
    status = ""
    try:
        with view or fitting() as shown:
            for standing in follow(connection, run):
                shown.show(standing)
                status = standing.record["status"]
    except KeyboardInterrupt:
        print(LEFT.format(f"Run {run}", run[:8]), flush=True)
        raise
    return status


def watch_sweep(connection: Connection, sweep: str, view: View | None = None) -> dict[str, Any]:
    """The sweep's record once all of its runs have ended."""
    record: dict[str, Any] = {}
    try:
        with view or fitting() as shown:
            for record in _sweep(connection, sweep):
                shown.show(Standing(as_run(record)))
    except KeyboardInterrupt:
        print(LEFT.format(f"Sweep {sweep}", sweep[:8]), flush=True)
        raise
    return record


def _sweep(connection: Connection, sweep: str) -> Iterator[dict[str, Any]]:
    while True:
        record = connection.read(f"sweeps/{sweep}")
        yield record
        if all(status in ENDED for status, count in record["standing"].items() if count):
            return
        time.sleep(POLL)


def as_run(sweep: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep as the views know runs: what is counted are runs that have ended."""
    standing = {status: count for status, count in sweep["standing"].items() if count}
    over = sum(count for status, count in standing.items() if status in ENDED)
    ended = next(
        (status for status in ("failed", "cancelled") if status in standing), "finished"
    )
    status = "running" if over < sweep["total"] else ended
    return {
        "id": sweep["id"],
        "experiment": "sweep",
        "name": sweep["name"],
        "status": status,
        "progress": sweep.get("progress", over / max(1, sweep["total"])),
        "generation": over,
        "generations": sweep["total"],
        "unit": "runs",
        "summary": standing,
    }
