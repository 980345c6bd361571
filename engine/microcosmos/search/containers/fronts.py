"""Pareto fronts in cells: MOME (Pierrot et al., GECCO 2022, arXiv:2202.03057).

Of a front that is too long the least crowded remain, as in MOME-PGX (Janmohamed, Pierrot and
Cully, GECCO 2023, arXiv:2302.12668); crowding distance: Deb et al., IEEE Trans. Evol. Comput.
6, 182 (2002).
"""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..cells import Axis, Cells
from ..insertion import Elites, height
from .survival import Survival

Rows = Int[Array, "row"]


class Fronts(Survival):
    """In each cell the elites that no other equals or exceeds in both of two objectives."""

    cells: Cells
    second: Axis
    """Second objective: its measure, and the ends and scale on which distances are taken."""
    size: int = eqx.field(static=True)
    """Longest front of a cell."""
    least: bool = eqx.field(static=True, default=True)
    """True if the least of the second objective is best."""

    def __check_init__(self) -> None:
        if self.size < 2:
            raise ValueError(f"`size` must be at least 2, the ends of a front, got {self.size}")

    @property
    def count(self) -> int:
        return self.cells.count * self.size

    def survivors(self, pool: Elites, position: Rows) -> Bool[Array, "row"]:
        """Return the rows of fronts, of long ones the ends and the least crowded."""
        value = pool.measures[:, self.second.measure]
        able = pool.occupied & jnp.isfinite(value)
        cell = jnp.where(able, self.cells.of(pool.measures), self.cells.count)
        best = able & front(cell, pool.fitness, -value if self.least else value, position)
        lengths = jnp.zeros(self.cells.count + 1, jnp.int32).at[cell].add(best)
        shortened = partial(
            self._shortened, best, cell, pool.fitness, self.second.place(value), position
        )
        return jax.lax.cond(jnp.max(lengths) > self.size, shortened, lambda: best)

    def _shortened(
        self,
        best: Bool[Array, "row"],
        cell: Rows,
        fitness: Float[Array, "row"],
        place: Float[Array, "row"],
        position: Rows,
    ) -> Bool[Array, "row"]:
        """Return the least crowded rows of each front; earlier ones among equally crowded."""
        cell = jnp.where(best, cell, self.cells.count)
        distance = crowding_distance(cell, fitness, place, position)
        order = jnp.lexsort((position, -distance, cell))
        number = jnp.arange(len(order), dtype=jnp.int32) - _ends(cell[order])[0]
        kept = number < self.size
        return best & jnp.zeros(len(order), bool).at[order].set(kept)


def front(
    cell: Rows, first: Float[Array, "row"], second: Float[Array, "row"], position: Rows
) -> Bool[Array, "row"]:
    """Return the rows that no other of their cell equals or exceeds in both objectives.

    Of rows equal in both, that with the smallest position is on the front. Numbers are finite.
    """
    first, second = height(first), height(second)
    order = jnp.lexsort((position, -second, -first, cell))
    # Rows before one in its cell are no worse in the first objective.
    cell, second = cell[order], second[order]
    place = jnp.arange(len(order), dtype=jnp.int32)
    highest, start = _highest(cell, second), _ends(cell)[0]
    best = (place == start) | (second > highest[place - 1])
    return jnp.zeros(len(order), bool).at[order].set(best)


def crowding_distance(
    cell: Rows, first: Float[Array, "row"], second: Float[Array, "row"], position: Rows
) -> Float[Array, "row"]:
    """Return the sum of the distances between each row's neighbours on its cell's front.

    Rows of a cell must be a front. Distances are shares of those between its ends, which have
    an infinite one.
    """
    order = jnp.lexsort((position, cell))  # A front is in the order of its fitness.
    start, stop = _ends(cell[order])
    place = jnp.arange(len(order), dtype=jnp.int32)
    before, after = jnp.maximum(place - 1, start), jnp.minimum(place + 1, stop)
    distance = jnp.zeros(len(order), first.dtype)
    for value in (first / 4, second):  # No difference of fitness exceeds the largest float.
        value = value[order]
        length = jnp.abs(value[start] - value[stop])
        gap = jnp.abs(value[before] - value[after])
        distance += jnp.where(length > 0, gap / jnp.where(length > 0, length, 1.0), 0.0)
    inner = (place > start) & (place < stop)
    return jnp.zeros_like(distance).at[order].set(jnp.where(inner, distance, jnp.inf))


def _highest(cell: Rows, value: Rows) -> Rows:
    """Return the largest value up to each row of its cell; cells are sorted."""
    place = jnp.arange(len(cell), dtype=jnp.int32)

    def doubled(number: Int[Array, ""], highest: Rows) -> Rows:
        back = jnp.maximum(place - (1 << number), 0)
        return jnp.where(cell[back] == cell, jnp.maximum(highest, highest[back]), highest)

    return jax.lax.fori_loop(0, len(cell).bit_length(), doubled, value)


def _ends(cell: Rows) -> tuple[Rows, Rows]:
    """Return the first and the last row of each row's cell; cells are sorted."""
    start = jnp.searchsorted(cell, cell, side="left")
    stop = jnp.searchsorted(cell, cell, side="right") - 1
    return start.astype(jnp.int32), stop.astype(jnp.int32)
