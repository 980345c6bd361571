"""Follow a run or a sweep until it ends, by the server's stream of events."""

import json
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import httpx

from . import arguments
from .connection import Connection
from .errors import (
    RUN,
    SWEEP,
    Kinds,
    NoAnswer,
    NotFound,
    NotMicrocosmos,
    Refused,
    ServerError,
    not_ours,
    record,
)

RECORDS = ("run", "generation")
"""Kinds of events whose data is read."""
SILENCE = 40.0
"""Seconds without a byte after which a stream counts as dead; the server writes every 15 s."""


@dataclass(frozen=True)
class Event:
    """An event, of a kind that the server lists: `start`, `run`, `generation`, `elites`,
    `results`, `rewind`, `purge`, `sweep` or `reset`.

    A `beat` only shows that the stream is alive.
    """

    kind: str
    data: Any
    id: str | None = None


def events(connection: Connection, run: str | None = None) -> Iterator[Event]:
    """Yield new events in order, without an end.

    After an outage it continues after the last event, or with `reset` if the server has
    forgotten that one. Raise `ServerError` if no server answers within the connection's
    patience.
    """
    last: str | None = None
    pause = 0.5
    while True:
        try:
            for event in _stream(connection, run, last):
                last, pause = event.id or last, 0.5
                yield event
        # The stream broke off. `Last-Event-ID` continues it without a gap
        # (test_events_continue_after_the_last_id).
        except httpx.TransportError:
            pass
        yield Event("beat", None)
        time.sleep(pause)
        pause = min(8.0, 2 * pause)


def _stream(connection: Connection, run: str | None, last: str | None) -> Iterator[Event]:
    headers = {"Accept": "text/event-stream"} | ({"Last-Event-ID": last} if last else {})
    limits = httpx.Timeout(SILENCE, connect=5.0)
    options = {"params": {"run": run}, "headers": headers, "timeout": limits}
    with connection.stream("events", **options) as answer:
        try:
            for event in parsed(answer.iter_lines()):
                if event.kind in RECORDS:
                    data = record(event.data, connection.url, RUN)
                    event = replace(event, data=data)
                yield event
        except (ValueError, RecursionError) as error:
            raise not_ours(connection.url, "with an event that is no JSON") from error


def parsed(lines: Iterable[str]) -> Iterator[Event]:
    """Parse the lines of a stream; a comment or a bare id is a `beat`."""
    fields: dict[str, str] = {}
    for line in lines:
        if not line:
            if fields:
                yield _event(fields)
            fields = {}
            continue
        name, _, value = line.partition(":")
        # One space after the colon belongs to the format (HTML, server-sent events).
        value = value.removeprefix(" ")
        fields[name] = f"{fields[name]}\n{value}" if name == "data" in fields else value


def _event(fields: dict[str, str]) -> Event:
    if "data" not in fields:
        return Event("beat", None, fields.get("id"))
    return Event(fields.get("event", "message"), json.loads(fields["data"]), fields.get("id"))


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
    """Reason why the record may be out of date; None: it is current."""

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
        except ServerError as error:
            # A server whose database is away says so itself, with the status of a proxy.
            if not isinstance(error, NoAnswer) and error.status != 503:
                raise
            lost = lost or time.monotonic()
            # A server that never answered is an error at once; one that restarts is awaited.
            if not state.record or time.monotonic() - lost > OUTAGE:
                raise
            state.problem = str(error)
            yield state
            time.sleep(POLL)


def _sweep_states(connection: Connection, sweep: str, state: RunState) -> Iterator[RunState]:
    while True:
        state.record = as_run(record(connection.read(f"sweeps/{sweep}"), connection.url, SWEEP))
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
    state.record = _run(connection, run)
    columns = connection.read(f"runs/{run}/generations", points=POINTS)
    lists: Kinds = {name: (list,) for name in CURVES}
    columns = record(columns, connection.url, lists)
    state.curves = {name: columns[name] for name in CURVES}


def _run(connection: Connection, run: str) -> dict[str, Any]:
    return record(connection.read(f"runs/{run}"), connection.url, RUN)


def wait(connection: Connection, run: str, timeout: float | None) -> dict[str, Any]:
    """Return the record of a run once it has ended; raise `TimeoutError` if it does not."""
    limit = math.inf if timeout is None else arguments.seconds("timeout", timeout)
    deadline = time.monotonic() + limit
    pause = 0.25
    while (found := _run(connection, run))["status"] not in ENDED:
        remaining = deadline - time.monotonic()
        if remaining <= 0:
            raise TimeoutError(
                f"run {run} has not ended within {timeout} s; it is {found['status']}"
            )
        time.sleep(min(pause, remaining))
        # A run of a second is noticed soon, a long one is asked for rarely.
        pause = min(POLL, 2 * pause)
    return found
