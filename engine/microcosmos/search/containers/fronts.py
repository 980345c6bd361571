"""Pareto fronts in cells, and their figures: MOME (Pierrot et al., GECCO 2022).

MOQD score and global hypervolume are from there (arXiv:2202.03057). Of a front that is too long
the least crowded remain, as in MOME-PGX (Janmohamed, Pierrot and Cully, GECCO 2023,
arXiv:2302.12668), which also has the largest sum of objectives; crowding distance: Deb et al.,
IEEE Trans. Evol. Comput. 6, 182 (2002).
"""

from functools import partial
from math import fsum
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ... import exact
from ...bounds import refuse_uncountable
from ..cells import Axis, Cells
from ..insertion import Elites, height
from .survival import Survival

Rows = Int[Array, "row"]


class Fronts(Survival):
    """Elites of each cell that no other of the cell equals or exceeds in both objectives."""

    cells: Cells
    second: Axis
    """Second objective: its measure, and the ends and scale on which distances are taken."""
    size: int = eqx.field(static=True)
    """Longest front of a cell."""
    least: bool = eqx.field(static=True, default=True)
    """True if the least of the second objective is best."""

    def __check_init__(self) -> None:
        refuse_uncountable(2, size=self.size)  # The two ends of a front.

    @property
    def count(self) -> int:
        return self.cells.count * self.size

    def survivors(self, pool: Elites, position: Rows) -> Bool[Array, "row"]:
        """Return the rows on fronts.

        A front that is too long keeps its ends and its least crowded rows.
        """
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

    Among rows equal in both, the one with the smallest position is on the front. Numbers are
    finite.
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


Values = np.ndarray | jax.Array
Objective = Float[np.ndarray, "row"]


class FrontFigures(NamedTuple):
    """Figures of all fronts, in double precision; sums do not depend on the order of rows.

    The reference point is fitness 0 and the worst end of the second objective, which counts
    from 0 to 1 on its own scale.
    """

    moqd_score: float
    """Sum over cells of the hypervolume of a cell's front."""
    hypervolume: float
    """Hypervolume of the front of all elites."""
    largest_sum: float
    """Largest sum of fitness and second objective of an elite; 0 without elites."""
    mean_length: float
    """Elites for each cell that has one."""


def front_figures(fitness: Values, measures: Values, fronts: Fronts) -> FrontFigures:
    """Return the figures of elites, given as fitness (row) and measures (row, measure)."""
    if not len(fitness):
        return FrontFigures(0.0, 0.0, 0.0, 0.0)
    cell = np.asarray(fronts.cells.of(jnp.asarray(measures)))
    first, measures = np.asarray(fitness, np.float64), np.asarray(measures)
    second = scaled(fronts.second, measures[:, fronts.second.measure], least=fronts.least)
    return FrontFigures(
        moqd_score=hypervolume(cell, first, second),
        hypervolume=hypervolume(np.zeros_like(cell), first, second),
        largest_sum=float(np.max(first + second)),
        mean_length=len(cell) / len(np.unique(cell)),
    )


def hypervolume(cell: Int[np.ndarray, "row"], first: Objective, second: Objective) -> float:
    """Return the sum over cells of the area between their rows and the point (0, 0)."""
    order = np.lexsort((-second, -first, cell))
    cell, first, second = cell[order], np.maximum(first[order], 0.0), second[order]
    leads = np.append(True, cell[1:] != cell[:-1])
    row, start = np.cumsum(leads) - 1, np.flatnonzero(leads)
    column = np.arange(len(cell)) - start[row]
    widths = np.zeros((len(start), column.max() + 2))
    widths[row, column + 1] = np.maximum(second, 0.0)
    steps = np.diff(np.maximum.accumulate(widths, axis=1))[row, column]
    # An exact sum: the order of cells and rows, which containers may change, makes no
    # difference.
    return fsum((first * steps).tolist())


def scaled(axis: Axis, values: Float[np.ndarray, "row"], *, least: bool) -> Objective:
    """Return values from 0 to 1 on an axis' own scale; 1 is its low end if least is best."""
    low, high = axis.low, axis.high
    values = np.clip(np.asarray(values, np.float64), low, high)
    if axis.logarithmic:
        low, high, values = map(exact.logarithm, (low, high, values))
    place = (values - low) / (high - low)
    return 1 - place if least else place
