"""Blocks, their computation, and their dispatch to devices, which may join, leave or hang."""

import json
import logging
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from queue import Empty, SimpleQueue
from statistics import median
from typing import Any, Protocol

import jax
import numpy as np

from ..build import build
from ..experiments.evolution import Evolution
from ..search import Stopped
from ..spec import parse

RUNS = 4
"""Runs whose programs a helper keeps."""


@dataclass(frozen=True)
class Work:
    """One block to compute."""

    spec: str
    """The whole spec of the run as JSON."""
    program: str
    """A name of `Evolution.block_programs`."""
    items: Any
    """Arrays whose first axis is the block."""


@dataclass(frozen=True)
class Answer:
    """The results of a block."""

    found: Any
    """Results of the program, in NumPy arrays."""
    seconds: float
    """Time that the device took."""


@lru_cache(maxsize=RUNS)
def experiment_of(spec: str) -> Evolution:
    """Build the run of a spec, from which a helper takes the programs of blocks."""
    experiment = build(parse(json.loads(spec)))
    assert isinstance(experiment, Evolution)
    return experiment


def refusal(spec: str, device: str) -> str | None:
    """Return the reason why this process cannot compute the blocks of a run; None if it can."""
    try:
        own = experiment_of(spec).device
    except Exception as error:  # Such as a missing plug-in: whatever it is, others may compute.
        return f"{type(error).__name__}: {error}"
    return None if own == device else f"its device is {own!r}, the run's {device!r}"


def compute(work: Work) -> Answer:
    """Compute a block on the first device of this process."""
    program = experiment_of(work.spec).block_programs()[work.program]
    return timed(program, work.items, jax.local_devices()[0])


def timed(program: Any, items: Any, device: Any) -> Answer:
    """Compute a block on a device; return its results and time."""
    began = time.monotonic()
    results = jax.device_get(program(jax.device_put(items, device)))
    return Answer(results, time.monotonic() - began)


LATE = 3.0
"""A block that takes this many times the median is sent to a second device."""
CHECK_SECONDS = 0.2
"""Longest time before the dispatcher notices devices that joined, left or are late."""
NOBODY_SECONDS = 30.0
"""Time between two warnings that no device computes."""

log = logging.getLogger(__name__)


class Disagreement(ValueError):
    """Two devices of the same kind computed different results for one block."""


class Pending(Protocol):
    """A computation under way, as `concurrent.futures.Future`."""

    def add_done_callback(self, fn: Callable[[Any], object], /) -> object: ...

    def result(self) -> Answer: ...

    def cancel(self) -> object: ...


class Device(Protocol):
    """A device that computes blocks, here or elsewhere."""

    @property
    def name(self) -> str: ...

    @property
    def capacity(self) -> int:
        """Blocks that it takes at a time: the one it computes, and a spare where it is far."""
        ...

    def submit(self, work: Work) -> Pending: ...

    def fail(self, error: BaseException) -> None:
        """Note that a block has failed: it must not be listed again, or the error is raised."""
        ...


@dataclass
class Sending:
    """One block under way to one device."""

    number: int
    device: Device
    at: float
    pending: Pending | None = None
    is_first: bool = True


Arrival = tuple[Sending, Answer | None, BaseException | None]


@dataclass
class Dispatcher:
    """Computes blocks on the devices that `listed` returns at each moment.

    Every device has at most its capacity in flight. A late block is sent twice: the first
    answer counts, and both are compared.
    """

    listed: Callable[[], Sequence[Device]]
    seconds: float = 0.0
    """Device seconds of the answers that counted."""
    _arrivals: SimpleQueue[Arrival] = field(default_factory=SimpleQueue)
    _sent: list[Sending] = field(default_factory=list)
    _answers: dict[int, tuple[str, Answer]] = field(default_factory=dict)
    _times: deque[float] = field(default_factory=lambda: deque(maxlen=64))
    _next: int = 0

    def compute(self, works: Sequence[Work], stop: Callable[[], bool]) -> list[Any]:
        """Return the results of all blocks, in their order.

        Raises `Stopped` once `stop` is true, `Disagreement`, and whatever a device of this
        process raises; the failure of another only takes it from the list.
        """
        first, self._next = self._next, self._next + len(works)
        wanted = {first + i: work for i, work in enumerate(works)}
        unsent, warned = deque(wanted), time.monotonic()
        try:
            while any(number not in self._answers for number in wanted):
                if stop():
                    raise Stopped
                devices = self.listed()
                self._lose(devices, unsent)
                self._assign(devices, wanted, unsent)
                if not devices and time.monotonic() - warned > NOBODY_SECONDS:
                    log.warning("No helper computes for this run; it waits for one")
                    warned = time.monotonic()
                self._receive(unsent)
            return [self._answers[number][1].found for number in wanted]
        finally:
            self._forget(first)

    def _lose(self, devices: Sequence[Device], unsent: deque[int]) -> None:
        """Take back the blocks of devices that are gone."""
        for sending in [one for one in self._sent if one.device not in devices]:
            self._withdraw(sending, unsent)

    def _withdraw(self, sending: Sending, unsent: deque[int]) -> None:
        """End a sending without an answer; its block is sent again unless another has it."""
        self._sent.remove(sending)
        if sending.pending:
            sending.pending.cancel()
        number = sending.number
        if number not in self._answers and not self._under_way(number):
            unsent.appendleft(number)  # It has waited longest.

    def _under_way(self, number: int) -> list[Sending]:
        return [one for one in self._sent if one.number == number]

    def _assign(
        self, devices: Sequence[Device], wanted: dict[int, Work], unsent: deque[int]
    ) -> None:
        loads = [sum(one.device is device for one in self._sent) for device in devices]
        # First a block for each device, then a spare.
        for level in range(max((device.capacity for device in devices), default=0)):
            for at, device in enumerate(devices):
                if loads[at] != level or level >= device.capacity:
                    continue
                number = unsent.popleft() if unsent else self._late(device, level)
                if number is not None and number in wanted:
                    self._send(device, number, wanted[number])
                    loads[at] += 1

    def _late(self, device: Device, load: int) -> int | None:
        """Return a late block that an idle device should compute too."""
        if load or not self._times:
            return None
        late = time.monotonic() - LATE * median(self._times)
        for one in sorted(self._sent, key=lambda one: one.at):
            alone = len(self._under_way(one.number)) == 1
            if one.at < late and alone and one.number not in self._answers:
                return one.number
        return None

    def _send(self, device: Device, number: int, work: Work) -> None:
        sending = Sending(number, device, time.monotonic())
        sending.is_first = not self._under_way(number)
        if not sending.is_first:
            log.info("A block is late; %s computes it too", device.name)
        self._sent.append(sending)

        def arrived(pending: Pending) -> None:
            # Answers are fetched here, beside one another.
            try:
                self._arrivals.put((sending, pending.result(), None))
            except BaseException as error:  # Also a cancelled one.
                self._arrivals.put((sending, None, error))

        try:
            sending.pending = device.submit(work)
            sending.pending.add_done_callback(arrived)
        except Exception as error:  # Its connection is lost: as if the block had failed there.
            self._arrivals.put((sending, None, error))

    def _receive(self, unsent: deque[int]) -> None:
        """Wait for an answer, then take all that are there."""
        try:
            self._take(self._arrivals.get(timeout=CHECK_SECONDS), unsent)
            while True:
                self._take(self._arrivals.get_nowait(), unsent)
        except Empty:
            return

    def _take(self, arrival: Arrival, unsent: deque[int]) -> None:
        sending, answer, error = arrival
        if sending not in self._sent:  # It was withdrawn.
            return
        if answer is None:
            assert error is not None
            self._withdraw(sending, unsent)
            sending.device.fail(error)
            return
        self._sent.remove(sending)
        number, name = sending.number, sending.device.name
        if number in self._answers:  # The second answer to a late block checks the first.
            other, before = self._answers[number]
            if not _same(before.found, answer.found):
                raise Disagreement(
                    f"{other} and {name} computed different results for the same block: one of "
                    "them is broken. Test both (microcosmos doctor), take the broken one away, "
                    "and begin again from a checkpoint that it had no part in"
                )
            return
        self._answers[number] = name, answer
        self._times.append(answer.seconds)
        self.seconds += answer.seconds

    def _forget(self, first: int) -> None:
        """Drop the answers and spares of a generation; a late second answer stays awaited."""
        kept = {one.number for one in self._sent if one.number in self._answers}
        for sending in [one for one in self._sent if one.number not in kept]:
            self._withdraw(sending, deque())
        self._answers = {n: a for n, a in self._answers.items() if n in kept}


def _same(one: Any, other: Any) -> bool:
    """Return whether two results have the same bits."""
    pairs = zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True)
    return all(np.asarray(a).tobytes() == np.asarray(b).tobytes() for a, b in pairs)
