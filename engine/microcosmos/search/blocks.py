"""Evaluation of any number of creatures by blocks, over all local devices."""

from collections import deque
from collections.abc import Callable
from typing import TypeVar

import jax
import numpy as np
from jaxtyping import PyTree

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
    """Evaluate networks (or other items) of NumPy arrays, their number first.

    The last block is padded with its first item. Each device has one block in flight. Raises
    `Stopped` if `stop` is true before a block.
    """
    devices = jax.local_devices()
    flying: deque[Found] = deque()
    landed: list[Found] = []
    count = len(jax.tree.leaves(items)[0])
    for number, start in enumerate(range(0, count, block)):
        if stop():
            raise Stopped
        if len(flying) == len(devices):
            landed.append(jax.device_get(flying.popleft()))
        rows = np.arange(start, start + block)
        rows = np.where(rows < count, rows, start)
        part = jax.tree.map(lambda x, rows=rows: x[rows], items)
        flying.append(program(jax.device_put(part, devices[number % len(devices)])))
    landed += [jax.device_get(one) for one in flying]
    return jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *landed)
