"""Blocks: one compiled program evaluates a fixed number of creatures at a time.

Rollouts are chaotic, and a program of another shape rounds differently; so this one program
evaluates every creature, whatever its batch, slot, neighbours or device.
"""

from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

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


Found = TypeVar("Found")


class Stopped(Exception):
    """The run was asked to stop; the unfinished generation is dropped and repeated."""


def never() -> bool:
    return False


def evaluate_blocks(
    program: Callable[[PyTree], Found],
    items: PyTree[np.ndarray],
    *,
    block: int,
    stop: Callable[[], bool] = never,
) -> Found:
    """Evaluate networks (or other items) in NumPy arrays whose first axis counts them.

    The last block is padded with its first item. Each device has one block in flight. Raises
    `Stopped` if `stop` is true before a block.
    """
    devices = jax.local_devices()
    in_flight: deque[Found] = deque()
    finished: list[Found] = []
    count = len(jax.tree.leaves(items)[0])
    for number, start in enumerate(range(0, count, block)):
        if stop():
            raise Stopped
        if len(in_flight) == len(devices):
            finished.append(jax.device_get(in_flight.popleft()))
        rows = np.arange(start, start + block)
        rows = np.where(rows < count, rows, start)
        part = jax.tree.map(lambda x, rows=rows: x[rows], items)
        in_flight.append(program(jax.device_put(part, devices[number % len(devices)])))
    finished += [jax.device_get(one) for one in in_flight]
    return jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *finished)
