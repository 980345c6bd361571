"""The parameters that are fixed when a rollout is compiled, and helpers of all its parts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp

from ... import coupling

Pair = tuple[Any, ...]
"""A value along x and one along y, mostly of nodes (node,)."""
Ref = Any
"""Memory that a program reads and writes."""


@dataclass(frozen=True)
class Plan:
    """Parameters that are fixed when a program is compiled."""

    size: tuple[int, int]
    steps: int
    nodes: int
    """Nodes, filled up to a power of two."""
    delta: coupling.Kernel
    lengths: tuple[float, ...]
    """Step lengths of the forcing iterations."""
    turns: bool
    """True if the projection removes the rotation too."""
    force_factor: float
    interpreted: bool

    @property
    def cells(self) -> int:
        return self.size[0] * self.size[1]


def repeat(times: int, work: Callable, carry: Any) -> Any:
    """Call `work(number, carry)` for numbers from 0 below `times`; return the last carry.

    An unrolled loop needs more registers, so that fewer worlds are simulated at once.
    """
    return jax.lax.fori_loop(0, times, work, carry)


def divided(number, by: int) -> Pair:
    """Return quotient and remainder of numbers that are not negative."""
    divisor = jnp.asarray(by, number.dtype)
    return jax.lax.div(number, divisor), jax.lax.rem(number, divisor)


def wrapped(cell, cells: int):
    """Return a number or a coordinate within the box from one at most a box away."""
    cell = jnp.where(cell < 0, cell + cells, cell)
    return jnp.where(cell >= cells, cell - cells, cell)


def added(one: Pair, other: Pair) -> Pair:
    return one[0] + other[0], one[1] + other[1]


def difference(one: Pair, other: Pair) -> Pair:
    return one[0] - other[0], one[1] - other[1]
