"""A run as it stands, again and again until it ends: told by events, else asked for."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .connection import Connection
from .errors import NoAnswer, NotFound, NotMicrocosmos, Refused
from .streaming import Event, events

ENDED = ("finished", "failed", "cancelled")
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


def follow(connection: Connection, run: str) -> Iterator[Standing]:
    """The same object each time, brought up to date; it ends when the run has ended."""
    standing = Standing()
    lost: float | None = None
    while True:
        try:
            for found in _answered(connection, run, standing):
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
