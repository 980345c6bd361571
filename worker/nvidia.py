"""NVIDIA GPUs: list those that a process may use, and measure one."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import pynvml
from pynvml import NVMLError

T = TypeVar("T")


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


def measure(uuid: str) -> tuple[int | None, float | None]:
    """Return the memory in use, in bytes, and the load of a GPU; None if unknown."""
    try:
        with _library():
            handle = pynvml.nvmlDeviceGetHandleByUUID(uuid)
            return (
                _known(lambda: int(pynvml.nvmlDeviceGetMemoryInfo(handle).used)),
                _known(lambda: int(pynvml.nvmlDeviceGetUtilizationRates(handle).gpu) / 100),
            )
    except NVMLError:
        return None, None


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
