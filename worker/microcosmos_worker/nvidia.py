"""NVIDIA GPUs: list those that a process may use, and measure one."""

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import pynvml
from pynvml import NVMLError

T = TypeVar("T")
CORE = pynvml.NVML_TEMPERATURE_GPU

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Gpu:
    """A card, or a MIG instance of one, which is a device like any other."""

    uuid: str
    name: str
    memory_bytes: int
    card: str
    """UUID of the card."""


def visible() -> list[Gpu]:
    """Return the GPUs that answer and that CUDA_VISIBLE_DEVICES allows, in its order."""
    if os.environ.get("JAX_PLATFORMS") == "cpu":
        return []
    try:
        with _library():
            found = list(map(_card_and_instances, range(pynvml.nvmlDeviceGetCount())))
    except NVMLError:  # No driver, or one that fails.
        return []
    cards = [one[0] for one in found if one]
    gpus = [gpu for one in found for gpu in one[1:] or one]
    allowed = os.environ.get("CUDA_VISIBLE_DEVICES")
    return gpus if allowed is None else _allowed(allowed, cards, gpus)


@dataclass(frozen=True)
class Measurement:
    """The measurements of a GPU; None where it reports none."""

    memory_bytes: int | None = None
    load: float | None = None
    temperature_celsius: float | None = None
    ecc_errors: int | None = None
    """Memory errors of its lifetime that could not be corrected."""


def measure(uuid: str) -> Measurement:
    try:
        with _library():
            handle = pynvml.nvmlDeviceGetHandleByUUID(uuid)
            ecc = (pynvml.NVML_MEMORY_ERROR_TYPE_UNCORRECTED, pynvml.NVML_AGGREGATE_ECC)
            return Measurement(
                _known(lambda: int(pynvml.nvmlDeviceGetMemoryInfo(handle).used)),
                _known(lambda: int(pynvml.nvmlDeviceGetUtilizationRates(handle).gpu) / 100),
                _known(lambda: float(pynvml.nvmlDeviceGetTemperature(handle, CORE))),
                _known(lambda: int(pynvml.nvmlDeviceGetTotalEccErrors(handle, *ecc))),
            )
    except NVMLError:
        return Measurement()


class XidErrors:
    """Counts the errors that a card's driver reports (Xid) while this object lives."""

    def __init__(self, uuid: str):
        self.total = 0
        self._events: Any = None
        try:
            pynvml.nvmlInit()  # Never shut down: the driver would forget the events.
            handle = pynvml.nvmlDeviceGetHandleByUUID(uuid)
            if pynvml.nvmlDeviceIsMigDeviceHandle(handle):
                handle = pynvml.nvmlDeviceGetDeviceHandleFromMigDeviceHandle(handle)
            events = pynvml.nvmlEventSetCreate()
            kind = pynvml.nvmlEventTypeXidCriticalError
            pynvml.nvmlDeviceRegisterEvents(handle, kind, events)
            self._events = events
        except NVMLError as error:
            log.info("The driver reports no errors of %s: %s", uuid, error)

    def read(self) -> int:
        """Return the number of errors so far."""
        try:
            while self._events is not None:
                pynvml.nvmlEventSetWait_v2(self._events, 0)
                self.total += 1
        except NVMLError:  # There are no more, which is an error of its own.
            pass
        return self.total


def _allowed(names: str, cards: list[Gpu], found: list[Gpu]) -> list[Gpu]:
    """Return GPUs by number or start of UUID; like CUDA, stop at the first unknown one."""
    chosen: list[Gpu] = []
    for name in (part.strip() for part in names.split(",")):
        if name.isdigit() and int(name) < len(cards):
            card = cards[int(name)].uuid
            those = [gpu for gpu in found if gpu.card == card][:1]  # CUDA sees one instance.
        else:
            those = [g for g in (*cards, *found) if name and g.uuid.startswith(name)][:1]
        if not those:
            break
        chosen += those
    return chosen


def _card_and_instances(index: int) -> list[Gpu]:
    """Return a card and its MIG instances; nothing if the card fails."""
    try:
        handle = pynvml.nvmlDeviceGetHandleByIndex(index)
        card = _gpu(handle)
    except NVMLError:
        return []
    if not _known(lambda: pynvml.nvmlDeviceGetMigMode(handle)[0]):
        return [card]
    instance_at = partial(pynvml.nvmlDeviceGetMigDeviceHandleByIndex, handle)
    places = range(pynvml.nvmlDeviceGetMaxMigDeviceCount(handle))
    instances = [_known(partial(instance_at, place)) for place in places]
    return [card, *(_gpu(part, card.uuid) for part in instances if part)]


def _gpu(handle: Any, card: str | None = None) -> Gpu:
    uuid = pynvml.nvmlDeviceGetUUID(handle)
    size = int(pynvml.nvmlDeviceGetMemoryInfo(handle).total)
    return Gpu(uuid, pynvml.nvmlDeviceGetName(handle), size, card or uuid)


def _known(query: Callable[[], T]) -> T | None:
    """Return the result of a query; None if the GPU does not support it."""
    try:
        return query()
    except NVMLError:
        return None


@contextmanager
def _library() -> Iterator[None]:
    pynvml.nvmlInit()
    try:
        yield
    finally:
        pynvml.nvmlShutdown()
