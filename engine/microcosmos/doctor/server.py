"""Ask the server for its version, its health report and its workers."""

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

from ..client import Client, NoAnswer, NotAllowed, ServerError
from ..sizes import size
from ..version import VERSION
from .machine import Finding, ok, problem, warning

MAX_HEARTBEAT_AGE = 20.0
"""Seconds without a heartbeat after which a worker counts as dead."""
MIN_FREE_BYTES, LOW_FREE_BYTES = 1 << 30, 10 << 30
"""Bytes of free disk space: less than the first is a problem, than the second a warning."""
MAX_WRITE_SECONDS = 1.0
"""Longest time, in seconds, that 4 kB should take to reach the disk."""
NETWORK_FILE_SYSTEMS = ("nfs", "nfs4", "cifs", "smb3", "fuse.sshfs", "9p")
"""File systems on which SQLite's log does not work."""


def server(url: str | None, token: str | None) -> Iterator[Finding]:
    """Check the server; a missing one is a problem only if its address was given."""
    with Client(url, token, patience=1.0) as client:
        try:
            yield from _version(client)
            yield from _principal(client)
            yield from _health(client)
            # The whole answer: its header has the clock of the server.
            answer = client.connection.ask("GET", "workers")
            yield from workers(answer.json(), _server_time(answer))
        except NoAnswer as error:
            found, _, advice = str(error).partition(": ")
            level = problem if url else warning
            checks = "database, disk and Redis are not checked"
            yield level("server", f"{found}; {checks}", advice or "start it with `make run`")
        except NotAllowed as error:
            yield problem("server", str(error), "export MICROCOSMOS_TOKEN=..., or --token")
        except ServerError as error:
            yield problem("server", str(error), "correct --url or MICROCOSMOS_URL")


def _version(client: Client) -> Iterator[Finding]:
    version = client.connection.read("openapi.json")["info"]["version"]
    text = f"version {version} answers at {client.url}"
    if version == VERSION:
        yield ok("server", text)
    else:
        advice = "install the same version on both, or creatures may not check bit for bit"
        yield warning("server", f"{text}; this is {VERSION}", advice)


def _principal(client: Client) -> Iterator[Finding]:
    principal = client.connection.read("tokens/current")
    until = f", until {principal['expires_at']}" if principal["expires_at"] else ""
    yield ok(
        "server",
        f"you are “{principal['name']}” there, with the scope {principal['scope']}{until}",
    )


def _health(client: Client) -> Iterator[Finding]:
    try:
        report = client.connection.read("health")
    except NotAllowed:
        yield warning(
            "server",
            "only an admin may see its database, disk and Redis",
            "use a token with the scope admin",
        )
        return
    yield from database(report["database"])
    yield from disk(report["disk"], report["database"]["dialect"])
    yield from redis(report["redis"])


def database(report: Mapping[str, Any]) -> Iterator[Finding]:
    """Check that the database answers, with the tables of the server's version."""
    where = f"{report['dialect']} {report['version'] or ''} at {report['location']}"
    found, newest = report["revision"], report["newest_revision"]
    tables = f"{where}, tables of migration {found}"
    if not report["reachable"]:
        advice = "start it, restore it, or correct MICROCOSMOS_DATABASE_URL"
        yield problem("database", f"{where}: {report['error']}", advice)
    elif found == newest:
        yield ok("database", tables)
    elif found is None or found < newest:
        advice = "restart the server: it updates the tables"
        yield warning("database", f"{tables}; {newest} is the newest", advice)
    else:
        advice = "use the newer Microcosmos that made them, or another data folder"
        yield problem("database", f"{tables}; the server knows up to {newest}", advice)


def disk(report: Mapping[str, Any], dialect: str) -> Iterator[Finding]:
    """Check that the store has room, can be written to, and is fast."""
    where, free, seconds = report["location"], report["free_bytes"], report["write_seconds"]
    if free is not None:
        text = f"{size(free)} free at {where}"
        if free < MIN_FREE_BYTES:
            advice = "free some space, or choose another folder with MICROCOSMOS_DATA"
            yield problem("disk", text, advice)
        elif free < LOW_FREE_BYTES:
            yield warning("disk", text, "free some space soon: each run keeps an archive file")
        else:
            yield ok("disk", text)
    if not report["writable"]:
        advice = f"let the server write to it (chown, chmod {where}), or set MICROCOSMOS_DATA"
        if report["file_system"] == "s3":
            advice = "check AWS_ENDPOINT_URL, the credentials, and that the bucket exists"
        yield problem("disk", f"{where} cannot be written to: {report['error']}", advice)
    elif seconds > MAX_WRITE_SECONDS:
        text = f"writing to {where} takes {1000 * seconds:.0f} ms"
        yield warning("disk", text, "checkpoints wait for it; a local disk is faster")
    else:
        yield ok("disk", f"writing to {where} takes {1000 * seconds:.0f} ms")
    if report["file_system"] in NETWORK_FILE_SYSTEMS and dialect == "sqlite":
        yield warning(
            "disk",
            f"{where} is on a {report['file_system']} file system, where SQLite may lose data",
            "choose a local folder with MICROCOSMOS_DATA, or PostgreSQL with "
            "MICROCOSMOS_DATABASE_URL",
        )


def redis(report: Mapping[str, Any]) -> Iterator[Finding]:
    """Check that Redis answers, and that it keeps messages when it is full."""
    where = report["location"]
    if not report["reachable"]:
        advice = "start it, or correct MICROCOSMOS_REDIS_URL; without it `make run` has its own"
        yield problem("Redis", f"{where} does not answer: {report['error']}", advice)
        return
    yield ok("Redis", f"{report['version']} answers at {where}")
    if report["policy"] not in (None, "noeviction"):
        text = f"a full Redis drops messages (maxmemory-policy {report['policy']})"
        yield warning("Redis", text, "set its maxmemory-policy to noeviction")


def workers(records: list[dict[str, Any]], now: datetime) -> Iterator[Finding]:
    """Check that there are workers, and that each has reported lately."""
    if not records:
        advice = "runs wait: start workers with `make run`, several with WORKERS=n"
        yield warning("workers", "no worker is alive", advice)
    for one in records:
        age = max(0.0, (now - datetime.fromisoformat(one["heartbeat_at"])).total_seconds())
        text = f"{one['name']} on {one['device']}, {one['status']}, reported {age:.0f} s ago"
        if age > MAX_HEARTBEAT_AGE:
            yield warning("workers", text, "it may hang: read its log, restart it")
        else:
            yield ok("workers", text)


def _server_time(answer: httpx.Response) -> datetime:
    """Return the server's own time: clocks differ."""
    date = answer.headers.get("date")
    return parsedate_to_datetime(date) if date else datetime.now(UTC)
