"""The server's stream of events, resumed where it breaks off."""

import json
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import httpx

from .connection import Connection

SILENCE = 40.0
"""Seconds without a byte after which a stream counts as dead; the server writes every 15 s."""


@dataclass(frozen=True)
class Event:
    """An event of the kind `run`, `generation`, `elites`, `results`, `rewind` or `reset`.

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
        except httpx.TransportError:
            pass
        yield Event("beat", None)
        time.sleep(pause)
        pause = min(8.0, 2 * pause)


def _stream(connection: Connection, run: str | None, last: str | None) -> Iterator[Event]:
    headers = {"Accept": "text/event-stream"} | ({"Last-Event-ID": last} if last else {})
    limits = httpx.Timeout(SILENCE, connect=5.0)
    asked = {"params": {"run": run}, "headers": headers, "timeout": limits}
    with connection.stream("events", **asked) as answer:
        yield from parsed(answer.iter_lines())


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
        value = value.removeprefix(" ")
        fields[name] = f"{fields[name]}\n{value}" if name == "data" in fields else value


def _event(fields: dict[str, str]) -> Event:
    if "data" not in fields:
        return Event("beat", None, fields.get("id"))
    return Event(fields.get("event", "message"), json.loads(fields["data"]), fields.get("id"))
