"""Figures of Pareto fronts: MOQD score, hypervolume, largest sum and mean length.

MOQD score and global hypervolume: Pierrot et al., GECCO 2022, arXiv:2202.03057; largest sum of
objectives: Janmohamed, Pierrot and Cully, GECCO 2023, arXiv:2302.12668.
"""

from math import fsum
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from ... import exact
from ..cells import Axis
from .fronts import Fronts

Rows = np.ndarray | jax.Array
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


def front_figures(fitness: Rows, measures: Rows, fronts: Fronts) -> FrontFigures:
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
    return fsum((first * steps).tolist())


def scaled(axis: Axis, values: Float[np.ndarray, "row"], *, least: bool) -> Objective:
    """Return values from 0 to 1 on an axis' own scale; 1 is its low end if least is best."""
    low, high = axis.low, axis.high
    values = np.clip(np.asarray(values, np.float64), low, high)
    if axis.logarithmic:
        low, high, values = map(exact.logarithm, (low, high, values))
    place = (values - low) / (high - low)
    return 1 - place if least else place
