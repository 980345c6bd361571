"""Follow a run or a sweep until it ends."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .connection import Connection
from .errors import NoAnswer, NotFound, NotMicrocosmos, Refused
from .streaming import Event, events

ENDED = ("finished", "failed", "cancelled")
PRECEDENCE = ("running", "queued", "paused", "failed", "cancelled")
"""The status of a sweep is the first of these that one of its runs has."""
POINTS = 400
POLL = 2.0
REFRESH = 20.0
"""Seconds after which everything is read again, whatever the stream has reported."""
OUTAGE = 600.0
"""Longest outage, in seconds, that is survived: laptops sleep, servers restart."""
CURVES = ("generation", "qd_score", "coverage", "best", "mean", "evaluations")


@dataclass
class RunState:
    """The record of a run, and its curves so far."""

    record: dict[str, Any] = field(default_factory=dict)
    curves: dict[str, list[Any]] = field(default_factory=dict)
    problem: str | None = None
    """Why it may be out of date."""

    @property
    def ended(self) -> bool:
        return self.record.get("status") in ENDED

    def update(self, event: Event) -> None:
        """Apply an event that needs no further request."""
        if event.kind == "run":
            self.record |= event.data
        elif event.kind == "generation":
            known = self.curves.get("generation", [])
            if not known or event.data["generation"] > known[-1]:
                for name, values in self.curves.items():
                    values.append(event.data.get(name))


Source = Callable[[Connection, str, RunState], Iterator[RunState]]
"""Updates a state, again and again, while the server answers."""


def follow(connection: Connection, run: str) -> Iterator[RunState]:
    """Yield the same object, updated, until the run has ended."""
    return _through_outages(_run_states, connection, run)


def follow_sweep(connection: Connection, sweep: str) -> Iterator[RunState]:
    """Yield the same object, updated, until all runs of the sweep have ended."""
    return _through_outages(_sweep_states, connection, sweep)


def _through_outages(source: Source, connection: Connection, id: str) -> Iterator[RunState]:
    state = RunState()
    lost: float | None = None
    while True:
        try:
            for found in source(connection, id, state):
                state.problem, lost = None, None
                yield found
                if found.ended:
                    return
        except NoAnswer as error:
            lost = lost or time.monotonic()
            if not state.record or time.monotonic() - lost > OUTAGE:
                raise
            state.problem = str(error)
            yield state
            time.sleep(POLL)


def _sweep_states(connection: Connection, sweep: str, state: RunState) -> Iterator[RunState]:
    while True:
        state.record = as_run(connection.read(f"sweeps/{sweep}"))
        yield state
        time.sleep(POLL)


def as_run(sweep: Mapping[str, Any]) -> dict[str, Any]:
    """Return a sweep as the record of a run, whose unit is a run that has ended."""
    counts = {status: count for status, count in sweep["status_counts"].items() if count}
    over = sum(count for status, count in counts.items() if status in ENDED)
    return {
        "id": sweep["id"],
        "experiment": "sweep",
        "name": sweep["name"],
        "status": next((status for status in PRECEDENCE if status in counts), "finished"),
        "progress": sweep.get("progress", over / max(1, sweep["total"])),
        "generation": over,
        "generations": sweep["total"],
        "unit": "runs",
        "summary": counts,
    }


def _run_states(connection: Connection, run: str, state: RunState) -> Iterator[RunState]:
    refresh(connection, run, state)
    yield state
    try:
        refreshed = float("-inf")  # What happened before the stream began has to be read.
        for event in events(connection, run):
            state.update(event)
            stale = time.monotonic() - refreshed > REFRESH
            if stale or event.kind in ("rewind", "reset") or state.ended:
                refresh(connection, run, state)
                refreshed = time.monotonic()
            yield state
    except (NotFound, NotMicrocosmos, Refused):  # Some proxies let no streams through.
        while not state.ended:
            time.sleep(POLL)
            refresh(connection, run, state)
            yield state


def refresh(connection: Connection, run: str, state: RunState) -> None:
    """Read everything again."""
    state.record = connection.read(f"runs/{run}")
    found = connection.read(f"runs/{run}/generations", points=POINTS)
    state.curves = {name: found[name] for name in CURVES}


def wait(connection: Connection, run: str, timeout: float | None) -> dict[str, Any]:
    """Return the record of a run once it has ended; raise `TimeoutError` if it does not."""
    deadline = float("inf") if timeout is None else time.monotonic() + timeout
    pause = 0.25
    while (record := connection.read(f"runs/{run}"))["status"] not in ENDED:
        remaining = deadline - time.monotonic()
        if remaining <= 0:
            raise TimeoutError(
                f"run {run} has not ended within {timeout} s; it is {record['status']}"
            )
        time.sleep(min(pause, remaining))
        pause = min(POLL, 2 * pause)
    return record
