"""Deliver a run's reports to sinks without ever making the run wait.

Each sink has a process of its own, a thread that feeds it, and a bounded queue. What does not
fit into the queue is dropped and counted.
"""

import json
import logging
import math
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Lock, Thread, Timer
from typing import Any, BinaryIO, Self, cast

from ..archive.report import FIGURES, Report, curves_of
from .address import Address, Message, Record, send
from .process import LAST, LINGER

log = logging.getLogger(__name__)

LENGTH = 1000
"""Reports that wait for a slow sink."""
PICTURE_SECONDS = 300.0
"""Least time between two pictures of an archive."""
PATIENCE = 10.0
"""Seconds to wait after the end of a run for what is under way. The processes then go on alone,
for `process.LINGER` seconds at most: killed, they might leave half a database behind."""
COMMAND = (sys.executable, "-m", "microcosmos.viz.sink")

CURVES = ("qd_score", "coverage", "best", "mean", "evaluations", "infeasible")
_WHOLE = {*CURVES, *(one.name for one in FIGURES)}


def numbers(report: Report) -> dict[str, float]:
    """Return the finite numbers of a report that make curves; a dot in a name makes a group."""
    values: dict[str, Any] = {name: getattr(report, name) for name in CURVES}
    values |= curves_of(report.summary)
    return {
        _grouped(name): value
        for name, value in values.items()
        if isinstance(value, int | float) and math.isfinite(value)
    }


def _grouped(name: str) -> str:
    """Return the name of a curve with its group, which is the name of no other curve.

    A folder of MLflow has a file for each curve, and a file cannot be a folder too.
    """
    head, dot, rest = name.partition(".")
    return f"{head}{'_by' if dot and head in _WHOLE else ''}{dot}{rest}".replace(".", "/")


_LINGERING: list[subprocess.Popen[bytes]] = []
"""Processes that outlive their runs; they end by themselves."""


class Sinks:
    """The sinks of a run; without any, nothing happens."""

    def __init__(self, addresses: Sequence[Address], record: Record):
        self._feeds: list[Feed] = [Feed(address, record) for address in addresses]
        self._pictured = time.monotonic()

    @property
    def names(self) -> list[str]:
        """Return the addresses, as a record of the run names them."""
        return [str(feed.address) for feed in self._feeds]

    def report(self, report: Report) -> None:
        """Pass on the numbers of a generation."""
        if self._feeds:
            header = {"kind": "report", "step": report.generation, "values": numbers(report)}
            self._offer(Message(header))

    def checkpoint(self, generation: int, data: bytes) -> None:
        """Pass on an archive for a picture, if the last one is old."""
        now = time.monotonic()
        if self._feeds and now - self._pictured >= PICTURE_SECONDS:
            self._pictured = now
            self._offer(Message({"kind": "archive", "step": generation}, data))

    def close(self, generation: int, files: Mapping[str, bytes], *, done: bool) -> None:
        """Pass on the last files by name, and wait for a while.

        One warning for each sink counts what is dropped, or not delivered by then.
        """
        for name, data in files.items():
            header = {"kind": "file", "name": name, "step": generation}
            self._offer(Message(header, data))
        until, feeds = time.monotonic() + PATIENCE, self._feeds
        self._feeds = []
        # All first, so that sinks end side by side.
        for feed in feeds:
            feed.end(Message({"kind": "end", "done": done}))
        for feed in feeds:
            feed.close(until)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close(0, {}, done=False)  # It has no effect after another call.

    def _offer(self, message: Message) -> None:
        for feed in self._feeds:
            feed.offer(message)


class Feed:
    """The queue, thread and process of one sink."""

    def __init__(self, address: Address, record: Record):
        self.address, self._lock = address, Lock()
        self._queue: Queue[Message] = Queue(LENGTH)
        self._offered = self._delivered = self._archives = 0
        self._reason, self._refused = "it does not answer", dict[str, str]()
        try:
            self._process = subprocess.Popen(
                COMMAND,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C ends the run, not what it still delivers.
            )
        except OSError as error:
            self._process, self._reason = None, str(error)
            return
        opening = {"kind": "open", "sink": address.kind, "target": address.target}
        first = Message(opening | record.header())
        Thread(target=self._feed, args=[first], daemon=True).start()
        self._reader = Thread(target=self._read, daemon=True)
        self._reader.start()

    def offer(self, message: Message) -> None:
        """Take a message, unless the queue is full; of archives only one may wait."""
        self._offered += 1
        with self._lock, suppress(Full):
            if message.kind == "archive" and self._archives:
                return
            self._queue.put_nowait(message)
            self._archives += message.kind == "archive"  # Of those that found room.

    def end(self, message: Message) -> None:
        """Let the thread end after what waits; a full queue makes room."""
        while True:
            with suppress(Full):
                self._queue.put_nowait(message)
                return
            with suppress(Empty):  # Pictures need no count any more: none is offered later.
                self._queue.get_nowait()

    def close(self, until: float) -> None:
        """Wait for the process, and warn if something is lost."""
        if self._process:
            try:
                self._process.wait(max(0.0, until - time.monotonic()))
                self._reader.join(1.0)
            except subprocess.TimeoutExpired:
                _LINGERING.append(self._process)
                # A process that hangs may not have read that the run has ended.
                ending = Timer(LINGER + LAST, self._process.send_signal, [signal.SIGALRM])
                ending.daemon = True
                ending.start()
        if self._refused:
            log.warning(
                "Sink %s refuses %s (%s); it has all other values.",
                self.address,
                ", ".join(self._refused),
                next(iter(self._refused.values())),
            )
        lost = self._offered - self._delivered
        if lost:
            log.warning(
                "Sink %s: %s of %s messages are not delivered (%s); the run is not affected.",
                self.address,
                f"{lost:,}",
                f"{self._offered:,}",
                self._reason,
            )

    def _feed(self, first: Message) -> None:
        assert self._process
        assert self._process.stdin
        with suppress(OSError, ValueError), self._process.stdin as pipe:
            stream = cast(BinaryIO, pipe)
            send(stream, first)
            while True:
                message = self._queue.get()
                with self._lock:
                    self._archives -= message.kind == "archive"
                send(stream, message)
                if message.kind == "end":
                    return

    def _read(self) -> None:
        """Record the answers of the process: delivered messages, and why others were not."""
        assert self._process
        assert self._process.stdout
        with suppress(OSError, ValueError), self._process.stdout as lines:
            for line in lines:
                answer = json.loads(line)
                self._delivered = answer["delivered"]
                self._reason = answer["error"] or self._reason
                self._refused = answer["refused"]
