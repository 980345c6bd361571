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
MEASURED = (
    ["-m", "microcosmos_server.main"],
    ["-m", "microcosmos_server.creatures.sandbox_process"],
)
INTERNAL_WORDS = ("Errno", "No module", "took too long", "cannot be read", "Traceback")
"""Words of internal errors, which a refusal must not contain."""


@dataclass
class Findings:
    refused: int = 0
    wrong: list[str] = field(default_factory=list)
    slowest: float = 0.0
    growth: int = 0
    """Most bytes by which the server and its sandboxes have grown."""


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
        with suppress(BlockingIOError):
            data = os.read(watch, 1 << 16)
            readings += [f"event {kind:#x}" for _, kind, _, _ in EVENT.iter_unpack(data)]
    finally:
        os.close(watch)


def all_cases(canary: Path) -> Iterable[Case]:
    return chain(malformed.cases(), malformed_hdf5.cases(canary))


def send(product: Installation, cases: Iterable[Case]) -> Findings:
    """Post each file as a creature; the server has to refuse it with the reason."""
    found, valid, before = Findings(), malformed.valid_document()["sha256"], None
    for case in cases:
        began = time.monotonic()
        answer = product.http.post(
            "/api/v1/creatures", content=case.body, headers={"Content-Type": case.kind}
        )
        if before is None:  # The first file has started the sandbox and warmed it up.
            before = memory(product)
        else:
            found.slowest = max(found.slowest, time.monotonic() - began)
            found.growth = max(found.growth, memory(product) - before)
        if answer.is_success and case.harmless and answer.json()["creature"] == valid:
            continue
        found.refused += 1
        text = f"{answer.status_code}: {answer.text}"
        reason = re.search(case.says, answer.text) and not any(
            word in text for word in INTERNAL_WORDS
        )
        if answer.status_code not in (413, 422) or not reason:
            found.wrong.append(f"{case.name}: not {case.says!r} but {text:.200}")
    return found


def memory(product: Installation) -> int:
    """Bytes in the memory of the server and its sandboxes."""
    total = 0
    for process in product.processes():
        with suppress(psutil.Error, OSError):  # A sandbox may end while it is measured.
            if process.cmdline()[1:] in MEASURED:
                total += process.memory_info().rss
    return total


HEAD = (
    b"POST /api/v1/creatures HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
)
FALSE_LENGTHS = {
    "too short a body": (b"Content-Length: 100\r\n\r\n{}", b""),
    "too long a body": (b"Content-Length: 1\r\nConnection: close\r\n\r\n{}", b" 4"),
    "no number": (b"Content-Length: many\r\n\r\n{}", b" 4"),
    "negative": (b"Content-Length: -1\r\n\r\n{}", b" 4"),
    "two lengths": (b"Content-Length: 2\r\nContent-Length: 1\r\n\r\n{}", b" 4"),
    "over the limit": (b"Content-Length: %d\r\n\r\n%s" % (10**10, b" " * (9 << 20)), b" 413"),
    "no chunks": (b"Transfer-Encoding: chunked\r\n\r\nmany\r\n{}", b" 4"),
}
"""Requests with false lengths, and the beginning of the status of their answers."""


def send_false_length(port: int, sent: bytes) -> bytes:
    """The first line of the answer to a request with a wrong length."""
    with socket.create_connection(("127.0.0.1", port), timeout=20) as connection:
        try:
            connection.sendall(HEAD + sent)
            connection.shutdown(socket.SHUT_WR)
            return connection.recv(1 << 16).partition(b"\r\n")[0]
        except OSError:  # The server hung up before the end.
            return b""
