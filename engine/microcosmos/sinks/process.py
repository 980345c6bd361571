"""The process of one sink, which `delivery` feeds."""

import json
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from queue import Empty, Queue
from threading import Thread
from typing import BinaryIO, Protocol, TextIO

from .messages import Message, receive
from .record import Record

BATCH = 100
"""Reports that are written together."""
WAITING = 200
"""Messages that are read ahead."""
NICE = 19
LINGER = 60
"""Seconds in which it may finish after the end of its run."""

Report = tuple[int, dict[str, float]]
"""A step and its numbers."""
Draw = Callable[[bytes], bytes | None]
"""Draws an archive file as PNG, where that is possible."""


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
        self._delivered = 0

    def take(self, messages: Sequence[Message]) -> None:
        """Deliver messages; an error loses them alone."""
        error = ""
        try:
            self._deliver(messages)
            self._delivered += len(messages)
        except Exception as problem:  # The libraries raise whatever they like.
            error = f"{type(problem).__name__}: {problem}"[:300]
        self.tell(error)

    def _deliver(self, messages: Sequence[Message]) -> None:
        header = messages[0].header
        if header["kind"] == "report":
            found = [(one.header["step"], one.header["values"]) for one in messages]
            self._sink.reports(found)
        elif header["kind"] == "archive":
            self._picture(messages[0])
        else:
            name, data = header["name"], messages[0].data
            if name.endswith(".h5"):
                self._picture(messages[0])
            self._sink.file(name, data)

    def _picture(self, message: Message) -> None:
        if drawn := self._draw(message.data):
            self._sink.picture(message.header["step"], drawn)

    def tell(self, error: str = "") -> None:
        print(json.dumps({"delivered": self._delivered, "error": error}), file=self._answers)
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


def read_ahead(stream: BinaryIO, waiting: "Queue[Message | None]") -> None:
    """Read messages until the run ends or dies; then the process may linger."""
    while message := receive(stream):
        waiting.put(message)
        if message.kind == "end":
            break
    signal.alarm(LINGER)
    waiting.put(None)


def main(draw: Draw) -> None:
    """Deliver what arrives at standard input; say on standard output what was delivered."""
    os.nice(NICE)
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Libraries print.
    opening = receive(sys.stdin.buffer)
    if opening is None:
        return
    waiting: Queue[Message | None] = Queue(WAITING)
    Thread(target=read_ahead, args=[sys.stdin.buffer, waiting], daemon=True).start()
    try:
        sink = open_sink(opening)
    except Exception as problem:  # See `Deliveries.take`.
        error = f"{type(problem).__name__}: {problem}"[:300]
        print(json.dumps({"delivered": 0, "error": error}), file=answers, flush=True)
        return
    deliveries, done = Deliveries(sink, answers, draw), False
    for messages in groups(waiting):
        if messages[0].kind == "end":
            done = messages[0].header["done"]
        else:
            deliveries.take(messages)
    sink.close(done)
