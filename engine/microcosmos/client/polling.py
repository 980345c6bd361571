"""A run or a sweep as it stands, again and again until it ends."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .connection import Connection
from .errors import NoAnswer, NotFound, NotMicrocosmos, Refused
from .streaming import Event, events

ENDED = ("finished", "failed", "cancelled")
TOLD_FIRST = ("running", "queued", "paused", "failed", "cancelled")
"""Of a sweep whose runs are in several states, the one that it is in."""
POINTS = 400
POLL = 2.0
AFRESH = 20.0
"""Seconds after which everything is asked for again, whatever the stream has told."""
OUTAGE = 600.0
"""Seconds without an answer that are survived: laptops sleep, servers start again."""
CURVES = ("generation", "qd_score", "coverage", "best", "mean", "evaluations")


@dataclass
class Standing:
    """What is known of a run, and its curves so far."""

    record: dict[str, Any] = field(default_factory=dict)
    curves: dict[str, list[Any]] = field(default_factory=dict)
    trouble: str | None = None
    """Why it may be out of date."""

    @property
    def ended(self) -> bool:
        return self.record.get("status") in ENDED

    def tell(self, event: Event) -> None:
        """Take in an event that says all by itself."""
        if event.kind == "run":
            self.record |= event.data
        elif event.kind == "generation" and self._goes_on(event.data):
            for name, values in self.curves.items():
                values.append(event.data.get(name))

    def _goes_on(self, told: Mapping[str, Any]) -> bool:
        known = self.curves.get("generation", [])
        return not known or told["generation"] > known[-1]


Answered = Callable[[Standing], Iterator[Standing]]
"""Brings a standing up to date, again and again, while the server answers."""


def follow(connection: Connection, run: str) -> Iterator[Standing]:
    """The same object each time, brought up to date; it ends when the run has ended."""
    return _through_outages(lambda standing: _answered(connection, run, standing))


def follow_sweep(connection: Connection, sweep: str) -> Iterator[Standing]:
    """The same for all runs of a sweep together, which stand as one."""
    return _through_outages(lambda standing: _asked(connection, sweep, standing))


def _through_outages(answered: Answered) -> Iterator[Standing]:
    standing = Standing()
    lost: float | None = None
    while True:
        try:
            for found in answered(standing):
                standing.trouble, lost = None, None
                yield found
                if found.ended:
                    return
        except NoAnswer as error:
            lost = lost or time.monotonic()
            if not standing.record or time.monotonic() - lost > OUTAGE:
                raise
            standing.trouble = str(error)
            yield standing
            time.sleep(POLL)


def _asked(connection: Connection, sweep: str, standing: Standing) -> Iterator[Standing]:
    while True:
        standing.record = as_run(connection.read(f"sweeps/{sweep}"))
        yield standing
        time.sleep(POLL)


def as_run(sweep: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep as the views know runs: what is counted are runs that have ended."""
    standing = {status: count for status, count in sweep["status_counts"].items() if count}
    over = sum(count for status, count in standing.items() if status in ENDED)
    return {
        "id": sweep["id"],
        "experiment": "sweep",
        "name": sweep["name"],
        "status": next((status for status in TOLD_FIRST if status in standing), "finished"),
        "progress": sweep.get("progress", over / max(1, sweep["total"])),
        "generation": over,
        "generations": sweep["total"],
        "unit": "runs",
        "summary": standing,
    }


def _answered(connection: Connection, run: str, standing: Standing) -> Iterator[Standing]:
    """While the server answers."""
    refresh(connection, run, standing)
    yield standing
    try:
        yield from _streamed(connection, run, standing)
    except (NotFound, NotMicrocosmos, Refused):  # Some proxies let no streams through.
        while not standing.ended:
            time.sleep(POLL)
            refresh(connection, run, standing)
            yield standing


def _streamed(connection: Connection, run: str, standing: Standing) -> Iterator[Standing]:
    asked = float("-inf")  # What happened before the stream began has to be asked for.
    for event in events(connection, run):
        standing.tell(event)
        stale = time.monotonic() - asked > AFRESH
        if stale or event.kind in ("rewind", "reset") or standing.ended:
            refresh(connection, run, standing)
            asked = time.monotonic()
        yield standing


def refresh(connection: Connection, run: str, standing: Standing) -> None:
    """Everything, as the server has it now."""
    standing.record = connection.read(f"runs/{run}")
    told = connection.read(f"runs/{run}/generations", points=POINTS)
    standing.curves = {name: told[name] for name in CURVES}


def wait(connection: Connection, run: str, timeout: float | None) -> dict[str, Any]:
    """The record of a run once it has ended; `TimeoutError` where that takes longer."""
    begun, pause = time.monotonic(), 0.25
    while True:
        record = connection.read(f"runs/{run}")
        if record["status"] in ENDED:
            return record
        left = float("inf") if timeout is None else begun + timeout - time.monotonic()
        if left <= 0:
            raise TimeoutError(
                f"run {run} has not ended within {timeout} s; it is {record['status']}"
            )
        time.sleep(min(pause, left))
        pause = min(POLL, 2 * pause)
