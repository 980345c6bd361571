"""Blocks: one compiled program evaluates a fixed number of creatures at a time.

Rollouts are chaotic, and a program of another shape rounds differently; so this one program
evaluates every creature, whatever its batch, slot, neighbours or device.
"""

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol, TypeVar

import jax
import numpy as np
from jaxtyping import Array, PyTree

from ..device import compiler_options


def block_program(function: Callable) -> Callable:
    """Compile a program that applies a function to every item of a block, such as genotypes."""
    return jax.jit(lambda block: mapped(function, block), compiler_options=compiler_options())


def mapped(function: Callable, block: PyTree[Array]) -> Any:
    """Apply a function to every item of a block: in turn on a CPU, elsewhere as a batch.

    On a CPU one world fits in a core's cache and a block keeps one core busy (measured
    faster than a batch, with one device per core).
    """
    if jax.default_backend() == "cpu":
        return jax.lax.map(function, block)
    return jax.vmap(function)(block)


Result = TypeVar("Result")


class Stopped(Exception):
    """The run was asked to stop; the unfinished generation is dropped and repeated."""


def never() -> bool:
    return False


def evaluate_blocks(
    program: Callable[[PyTree], Result],
    items: PyTree[np.ndarray],
    *,
    block: int,
    stop: Callable[[], bool] = never,
) -> Result:
    """Evaluate networks (or other items) in NumPy arrays whose first axis counts them.

    The last block is padded with its first item. Each device has one block in flight. Raises
    `Stopped` if `stop` is true before a block.
    """
    devices = jax.local_devices()
    in_flight: deque[Result] = deque()
    finished: list[Result] = []
    for number, part in enumerate(blocks_of(items, block)):
        if stop():
            raise Stopped
        # JAX does not wait for results. One block at a time for each device keeps to the memory
        # that `spec.estimate` counts, and a stop acts between blocks.
        if len(in_flight) == len(devices):
            finished.append(jax.device_get(in_flight.popleft()))
        # One program for each device, not one that is sharded over all: that changed bits.
        # Files of one and two devices are compared in tests/engine/experiments/test_devices.py.
        in_flight.append(program(jax.device_put(part, devices[number % len(devices)])))
    finished += [jax.device_get(one) for one in in_flight]
    return joined(finished, items)


def blocks_of(items: PyTree[np.ndarray], block: int) -> Iterator[PyTree[np.ndarray]]:
    """Yield the blocks of items; the last is padded with its first item."""
    count = _count(items)
    for start in range(0, count, block):
        rows = np.arange(start, start + block)
        # A program of another shape would round differently, so the last block has as many
        # rows.
        rows = np.where(rows < count, rows, start)
        yield jax.tree.map(lambda x, rows=rows: x[rows], items)


def joined(results: Sequence[Result], items: PyTree[np.ndarray]) -> Result:
    """Return the results of the items from those of their blocks."""
    count = _count(items)
    return jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *results)


def _count(items: PyTree[np.ndarray]) -> int:
    return len(jax.tree.leaves(items)[0])


class Devices(Protocol):
    """The devices that evaluate the blocks of a run: this process's, or those of many hosts."""

    def evaluate(
        self,
        program: Callable[[PyTree], Result],
        items: PyTree[np.ndarray],
        *,
        block: int,
        stop: Callable[[], bool] = never,
    ) -> Result:
        """Evaluate items as `evaluate_blocks` does, to the same bits."""
        ...

    def seconds(self) -> float:
        """Return a clock of device seconds; only its differences mean something."""
        ...

    def summary(self) -> dict[str, float]:
        """Return figures for the report of a generation, since the last call."""
        ...


class LocalDevices:
    """The devices of this process; they count as busy while a generation is evaluated."""

    evaluate = staticmethod(evaluate_blocks)

    def seconds(self) -> float:
        return time.monotonic() * jax.local_device_count()

    def summary(self) -> dict[str, float]:
        return {}
