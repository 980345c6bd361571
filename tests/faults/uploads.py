"""Send malformed files to a server, and watch its memory and other files."""

import ctypes
import os
import re
import socket
import struct
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import malformed
import malformed_hdf5
import psutil
from drive import Installation
from malformed import Case

IN_ACCESS, IN_OPEN = 0x1, 0x20
EVENT = struct.Struct("iIII")
OURS = ("Errno", "No module", "took too long", "cannot be read", "Traceback")
"""Words of internal errors, which a refusal must not contain."""


@dataclass
class Findings:
    refused: int = 0
    wrong: list[str] = field(default_factory=list)
    slowest: float = 0.0
    growth: int = 0
    """Bytes by which the server and its quarantine have grown, at most."""


@contextmanager
def watched(canary: Path) -> Iterator[list[str]]:
    """Collect the kernel's events of opening or reading a file."""
    libc, readings = ctypes.CDLL(None, use_errno=True), []
    watch = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    assert watch >= 0
    added = libc.inotify_add_watch(watch, os.fsencode(canary), IN_ACCESS | IN_OPEN)
    assert added >= 0, os.strerror(ctypes.get_errno())
    try:
        yield readings
        readings += [f"event {kind:#x}" for kind in events(watch)]
    finally:
        os.close(watch)


def events(watch: int) -> Iterator[int]:
    try:
        data = os.read(watch, 1 << 16)
    except BlockingIOError:
        return
    for at in range(0, len(data), EVENT.size):  # Without names: a file is watched, no folder.
        yield EVENT.unpack_from(data, at)[1]


def all_cases(canary: Path) -> Iterable[Case]:
    return chain(malformed.cases(), malformed_hdf5.cases(canary))


def send(place: Installation, cases: Iterable[Case]) -> Findings:
    """Post each file as a creature's; the answer has to refuse it with what was wrong."""
    found, expected = Findings(), malformed.good()["sha256"]
    before = None
    for case in cases:
        began = time.monotonic()
        answer = place.http.post(
            "/api/v1/creatures", content=case.body, headers={"Content-Type": case.kind}
        )
        if before is None:  # Its first file has started the quarantine, and warmed it up.
            before = memory(place)
        else:
            found.slowest = max(found.slowest, time.monotonic() - began)
            found.growth = max(found.growth, memory(place) - before)
        if answer.is_success and case.harmless and answer.json()["creature"] == expected:
            continue
        found.refused += 1
        if fault := complaint(case, answer.status_code, answer.text):
            found.wrong.append(f"{case.name}: {fault}")
    return found


def complaint(case: Case, status: int, text: str) -> str | None:
    if status not in (413, 422):
        return f"status {status}: {text:.200}"
    if not re.search(case.says, text) or any(word in text for word in OURS):
        return f"not {case.says!r} but {text:.200}"
    return None


def memory(place: Installation) -> int:
    """Bytes in the memory of the server and of the sandboxes that read files for it."""
    total = 0
    sandboxes = place.named("server.creatures.sandbox_process")
    for process in place.named("server.main") + sandboxes:
        with suppress(psutil.Error, OSError):  # A sandbox may end meanwhile.
            total += process.memory_info().rss
    return total


HEAD = (
    b"POST /api/v1/creatures HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
)
LIES = {
    "less than it says": (b"Content-Length: 100\r\n\r\n{}", b""),
    "more than it says": (b"Content-Length: 1\r\nConnection: close\r\n\r\n{}", b" 4"),
    "no number": (b"Content-Length: many\r\n\r\n{}", b" 4"),
    "below zero": (b"Content-Length: -1\r\n\r\n{}", b" 4"),
    "two of them": (b"Content-Length: 2\r\nContent-Length: 1\r\n\r\n{}", b" 4"),
    "more than there is room for": (
        b"Content-Length: 10000000000\r\n\r\n" + b" " * (9 << 20),
        b" 413",
    ),
    "chunks that are none": (b"Transfer-Encoding: chunked\r\n\r\nmany\r\n{}", b" 4"),
}
"""Lengths that are not those of what is sent, and the beginning of the status they get."""


def lie(port: int, sent: bytes) -> bytes:
    """The first line of the answer to a request with a wrong length."""
    with socket.create_connection(("127.0.0.1", port), timeout=20) as connection:
        try:
            connection.sendall(HEAD + sent)
            connection.shutdown(socket.SHUT_WR)
            return connection.recv(1 << 16).partition(b"\r\n")[0]
        except OSError:  # The server hung up in the midst of it.
            return b""
