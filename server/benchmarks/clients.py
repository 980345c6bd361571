"""Clients that load a server; each function runs in a process of its own."""

import http.client
import json
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from threading import Lock
from typing import Any

PATIENCE = 60.0
ANSWERED = (200, 202)


class Refused(RuntimeError):
    """The server answered with an error."""


def ask(
    connection: http.client.HTTPConnection,
    path: str,
    body: Any = None,
    headers: dict[str, str] | None = None,
) -> bytes:
    """Return the bytes of an answer as they came, still compressed."""
    sent = None if body is None else json.dumps(body)
    given = {"Accept-Encoding": "gzip", "Content-Type": "application/json", **(headers or {})}
    connection.request("POST" if sent else "GET", path, sent, given)
    answer = connection.getresponse()
    content = answer.read()
    if answer.status not in ANSWERED:
        raise Refused(f"{path}: {answer.status} {content[:300]!r}")
    return content


def on_time(
    port: int, path: str, rate: float, seconds: float, headers: dict[str, str], threads: int = 8
) -> list[float]:
    """Send requests at fixed times; return the seconds from each time to the end of the answer.

    A late answer makes those that wait for its connection late too, and they count so.
    """
    begun, numbers, lock = time.monotonic() + 0.2, count(), Lock()

    def one_connection(_: int) -> list[float]:
        connection, taken = http.client.HTTPConnection("127.0.0.1", port, PATIENCE), []
        while True:
            with lock:
                due = begun + next(numbers) / rate
            if due > begun + seconds:
                return taken
            time.sleep(max(0.0, due - time.monotonic()))
            ask(connection, path, None, headers)
            taken.append(time.monotonic() - due)

    return _together(threads, one_connection)


def post_all(port: int, path: str, bodies: list[Any], threads: int) -> list[float]:
    """Post documents from some threads, each after its last; return the seconds of each."""
    return _each([(path, body) for body in bodies], port, {}, threads)


def all_of(port: int, paths: list[str], headers: dict[str, str], threads: int) -> list[float]:
    """Read paths from some threads, each after its last; return the seconds of each."""
    return _each([(path, None) for path in paths], port, headers, threads)


def _each(
    requests: list[tuple[str, Any]], port: int, headers: dict[str, str], threads: int
) -> list[float]:
    left, lock = list(requests), Lock()

    def one_connection(_: int) -> list[float]:
        connection, taken = http.client.HTTPConnection("127.0.0.1", port, PATIENCE), []
        while True:
            with lock:
                if not left:
                    return taken
                path, body = left.pop()
            begun = time.monotonic()
            ask(connection, path, body, headers)
            taken.append(time.monotonic() - begun)

    return _together(threads, one_connection)


def watch(port: int, path: str, watchers: int, last: int) -> list[bool]:
    """Follow events over some connections up to a generation; tell which missed none."""

    def one(_: int) -> list[bool]:
        connection = http.client.HTTPConnection("127.0.0.1", port, PATIENCE)
        connection.request("GET", path)
        answer, found = connection.getresponse(), [0]
        while found[-1] < last and (line := answer.readline()):
            if line.startswith(b"event: generation"):
                found.append(
                    json.loads(answer.readline().removeprefix(b"data: "))["generation"]
                )
        connection.close()
        return [found[1:] == list(range(found[1], last + 1))]

    return _together(watchers, one)


def _together(threads: int, work: Callable[[int], list[Any]]) -> list[Any]:
    with ThreadPoolExecutor(threads) as pool:
        return [one for part in pool.map(work, range(threads)) for one in part]
