"""The server at an address: which version, can it work, who works for it."""

from collections.abc import Iterator
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

from ..client import Client, NoAnswer, NotAllowed, ServerError
from ..version import VERSION
from .finding import Finding, ok, problem, warning

SILENT = 20.0
"""Seconds without a heartbeat after which a worker counts as dead."""


def server(url: str | None, token: str | None) -> Iterator[Finding]:
    """Where an address was chosen somebody has to answer, else perhaps nobody was started."""
    with Client(url, token, patience=5.0) as client:
        try:
            yield from _asked(client)
        except NoAnswer as error:
            found, _, advice = str(error).partition(": ")
            judged = problem if url else warning
            yield judged("server", found, advice or "start it with `make run`")
        except NotAllowed as error:
            yield problem("server", str(error), "export MICROCOSMOS_TOKEN=..., or --token")
        except ServerError as error:
            yield problem("server", str(error), "correct --url or MICROCOSMOS_URL")


def _asked(client: Client) -> Iterator[Finding]:
    connection = client.connection
    told = connection.read("openapi.json")["info"]["version"]
    if told == VERSION:
        yield ok("server", f"version {told} answers at {client.url}")
    else:
        yield warning(
            "server",
            f"version {told} answers at {client.url}; this is {VERSION}",
            "install the same version on both, or creatures may not check bit for bit",
        )
    yield from _ready(connection.http.get("/readyz"))
    yield from _caller(client)
    answer = connection.ask("GET", "workers")
    yield from workers(answer.json(), _now(answer))


def _ready(answer: httpx.Response) -> Iterator[Finding]:
    try:
        standing = answer.json()
    except ValueError:
        standing = {}
    for name in ("database", "redis"):
        if standing.get(name) != "ok":
            told = f"it does not reach its {name.replace('redis', 'Redis')}"
            yield problem("server", told, f"start the {name}; the server's log says more")


def _caller(client: Client) -> Iterator[Finding]:
    """Who one is there, and what one may."""
    told = client.connection.read("tokens/current")
    until = f", until {told['expires_at']}" if told["expires_at"] else ""
    yield ok("server", f"you are “{told['name']}” there, with the scope {told['scope']}{until}")


def workers(found: list[dict[str, Any]], now: datetime) -> Iterator[Finding]:
    """Each worker, and how long ago it was heard of."""
    if not found:
        advice = "runs wait: `make run` starts one; WORKERS=n so many"
        yield warning("workers", "none is alive", advice)
    for one in found:
        age = max(0.0, (now - datetime.fromisoformat(one["heartbeat_at"])).total_seconds())
        told = f"{one['name']} on {one['device']}, {one['status']}, heard of {age:.0f} s ago"
        if age > SILENT:
            yield warning("workers", told, "it may hang: look at its log, start it again")
        else:
            yield ok("workers", told)


def _now(answer: httpx.Response) -> datetime:
    """The server's own time: clocks differ."""
    date = answer.headers.get("date")
    return parsedate_to_datetime(date) if date else datetime.now(UTC)
