"""The process of one sink, which `delivery` feeds."""

import json
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Thread
from typing import BinaryIO, Protocol, TextIO

from ..archive.file import HDF5
from .address import Message, Record, Refused, receive

BATCH = 100
"""Reports that are written together."""
WAITING = 200
"""Messages that are read ahead."""
NICE = 19
LINGER = 60
"""Seconds in which the process may finish after the end of its run."""
LAST = 10
"""Seconds after those in which it may still end its record."""

Report = tuple[int, dict[str, float]]
"""A step and its numbers."""
Draw = Callable[[bytes], bytes | None]
"""A function that draws an archive file as PNG; None if that is not possible."""


class Sink(Protocol):
    """A writer of records."""

    def reports(self, reports: Sequence[Report]) -> None:
        """Write numbers by name at their steps."""

    def picture(self, step: int, png: bytes) -> None:
        """Write a picture of the archive."""

    def file(self, name: str, data: bytes) -> None:
        """Keep a file of the run."""

    def close(self, done: bool) -> None:
        """End the record, or leave it to the next attempt."""


def open_sink(opening: Message) -> Sink:
    """Return the sink that the first message names; raise `ImportError` without its library."""
    header = opening.header
    record = Record(header["id"], header["name"], header["spec"], header["generation"])
    if header["sink"] == "tensorboard":
        from .tensorboard import TensorBoard

        return TensorBoard(header["target"], record)
    if header["sink"] == "mlflow":
        from .mlflow import MLflow

        return MLflow(header["target"], record)
    from .wandb import WeightsAndBiases

    return WeightsAndBiases(header["target"], record)


class Deliveries:
    """Hands messages to a sink, and counts those that it has taken."""

    def __init__(self, sink: Sink, answers: TextIO, draw: Draw):
        self._sink, self._answers, self._draw = sink, answers, draw
        self._delivered, self._refused = 0, dict[str, str]()

    def take(self, messages: Sequence[Message]) -> None:
        """Deliver messages; an error loses them alone."""
        error = ""
        try:
            self._deliver(messages)
            self._delivered += len(messages)
        except Refused as some:
            self._delivered += len(messages)
            self._refused |= {name: why[:300] for name, why in some.reasons.items()}
        except Exception as problem:  # The libraries raise whatever they like.
            error = f"{type(problem).__name__}: {problem}"[:300]
        self.tell(error)

    def _deliver(self, messages: Sequence[Message]) -> None:
        header = messages[0].header
        if header["kind"] == "report":
            reports = [(one.header["step"], one.header["values"]) for one in messages]
            self._sink.reports(reports)
        elif header["kind"] == "archive":
            self._picture(messages[0])
        else:
            name, data = header["name"], messages[0].data
            if data.startswith(HDF5):  # People name the archive file as they like.
                self._picture(messages[0])
            self._sink.file(name, data)

    def _picture(self, message: Message) -> None:
        if drawn := self._draw(message.data):
            self._sink.picture(message.header["step"], drawn)

    def tell(self, error: str = "") -> None:
        answer = {"delivered": self._delivered, "error": error, "refused": self._refused}
        print(json.dumps(answer), file=self._answers)
        self._answers.flush()


def groups(waiting: "Queue[Message | None]") -> Iterator[list[Message]]:
    """Yield messages until the end: reports that wait together, others alone."""
    together: list[Message] = []
    while True:
        try:
            message = waiting.get(block=not together)
        except Empty:
            yield together
            together = []
            continue
        if message is not None and message.kind == "report" and len(together) < BATCH:
            together.append(message)
            continue
        if together:
            yield together
            together = []
        if message is None:
            return
        if message.kind == "report":
            together = [message]
        else:
            yield [message]


class Overdue(BaseException):
    """The process has lingered for too long; no `except Exception` of a library stops it."""


def raise_overdue(*_: object) -> None:
    # The next alarm ends the process, whatever a library makes of this exception.
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(LAST)
    raise Overdue


class Reader:
    """Reads messages until the run ends or dies; then the process may linger."""

    def __init__(self, stream: BinaryIO):
        self.waiting: Queue[Message | None] = Queue(WAITING)
        self.done = self._lingers = self._drops = False
        self._parent = os.getppid()
        self._thread = Thread(target=self._read, args=[stream], daemon=True)
        self._thread.start()

    def drop(self) -> bool:
        """Skip what is left to read; return whether the run is done."""
        self._drops = self._lingers = True
        self._thread.join()
        return self.done

    def _read(self, stream: BinaryIO) -> None:
        while (message := receive(stream)) and message.kind != "end":
            self._put(message)
        self.done = message is not None and message.header["done"]
        self._linger()
        self._put(None)

    def _put(self, message: Message | None) -> None:
        while not self._drops:
            with suppress(Full):
                self.waiting.put(message, timeout=1.0)
                return
            # A sink that hangs would keep the end of the stream from being read.
            if os.getppid() != self._parent:
                self._linger()

    def _linger(self) -> None:
        if not self._lingers:
            self._lingers = True
            signal.alarm(LINGER)


def main(draw: Draw) -> None:
    """Deliver the messages of standard input; count the delivered ones on standard output."""
    os.nice(NICE)  # A run on all cores must not wait for its records.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Libraries print.
    opening = receive(sys.stdin.buffer)
    if opening is None:
        return
    signal.signal(signal.SIGALRM, raise_overdue)
    reader = Reader(sys.stdin.buffer)
    try:
        sink = open_sink(opening)
    except Exception as problem:  # See `Deliveries.take`.
        error = f"{type(problem).__name__}: {problem}"[:300]
        print(
            json.dumps({"delivered": 0, "error": error, "refused": {}}),
            file=answers,
            flush=True,
        )
        return
    deliveries = Deliveries(sink, answers, draw)
    try:
        for messages in groups(reader.waiting):
            deliveries.take(messages)
        sink.close(reader.done)
    except Overdue:
        sink.close(reader.drop())
