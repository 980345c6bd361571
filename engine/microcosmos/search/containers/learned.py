"""Learned axes, in the manner of AURORA (Grillotti and Cully, arXiv:2106.05648), with PCA."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ...archive import components
from ...bounds import refuse_beyond, refuse_uncountable
from ...invalid import InvalidField
from ...portable import long_product
from ..cells import Cells
from ..insertion import MAX_INT, Elites, zeros
from .survival import Survival


class Learned(eqx.Module):
    """The learned axes: see `archive.components.Components`."""

    mean: Float[Array, "measure"]
    scale: Float[Array, "measure"]
    weights: Float[Array, "axis measure"]
    explained: Float[Array, "axis"]
    low: Float[Array, "axis"]
    high: Float[Array, "axis"]
    epoch: Int[Array, ""]
    """Number of times that axes have been learned."""


class LearnedAxes(Survival):
    """One elite in each cell along axes that are learned from the measures of elites.

    A place is not a cell: an elite keeps its place when the axes are learned anew. Before the
    axes are first learned, the first in the total order survive.
    """

    cells: Cells
    learned: Learned
    columns: tuple[int, ...] = eqx.field(static=True)
    """Columns of the measures of which axes are made."""
    floors: tuple[float, ...] = eqx.field(static=True)
    """Least value of each that enters as a logarithm, 0 for the others."""
    dimensions: int = eqx.field(static=True)
    """Number of learned axes."""
    bins: int = eqx.field(static=True)
    first: int = eqx.field(static=True)
    """Generation in which the axes are learned for the second time."""

    def __check_init__(self) -> None:
        refuse_uncountable(1, dimensions=self.dimensions, bins=self.bins, first=self.first)

    @property
    def count(self) -> int:
        return self.bins**self.dimensions

    @property
    def epoch(self) -> int:
        """Number of times that axes have been learned."""
        return int(self.learned.epoch)

    def coordinates(
        self, measures: Float[Array, "row measure"]
    ) -> Float[Array, "row dimension"]:
        """Return the places of creatures along the learned axes."""
        known, columns = self.learned, []
        for column, floor in zip(self.columns, self.floors, strict=True):
            value = measures[:, column]
            columns.append(jnp.log(jnp.maximum(value, floor)) if floor else value)
        values, counts = jnp.stack(columns, 1), known.scale > 0
        apart = (values - known.mean[None]) / jnp.where(counts, known.scale, 1.0)[None]
        apart = jnp.clip(apart, -components.CLIP, components.CLIP)
        used = counts[None] & ~jnp.isnan(apart)
        return long_product(jnp.where(used, apart, 0.0), known.weights.T)

    def cell_of(self, measures: Float[Array, "row measure"]) -> Int[Array, "row"]:
        """Return the learned cell of each row; beyond an end it is an outer one."""
        known, cell = self.learned, jnp.zeros(len(measures), jnp.int32)
        share = (self.coordinates(measures) - known.low[None]) / (known.high - known.low)[None]
        bins = jnp.clip(jnp.floor(share * self.bins), 0, self.bins - 1).astype(jnp.int32)
        for axis in range(self.dimensions):
            cell = cell * self.bins + bins[:, axis]
        return cell

    def survivors(self, pool: Elites, position: Int[Array, "row"]) -> Bool[Array, "row"]:
        """Return the first of each learned cell in the total order."""
        count = self.count
        cell = jnp.where(pool.occupied, self.cell_of(pool.measures), count)
        first = jnp.full(count, MAX_INT).at[cell].min(position.astype(jnp.int32), mode="drop")
        best = position == first[jnp.minimum(cell, count - 1)]
        ahead = jnp.cumsum(jnp.zeros(len(position), jnp.int32).at[position].set(pool.occupied))
        return pool.occupied & jnp.where(self.learned.epoch > 0, best, ahead[position] <= count)

    def changes(self, generation: int) -> bool:
        """Return whether axes are learned in this generation.

        They are learned in the first, in `first`, whenever the number has doubled since, and in
        every generation as long as there are none.
        """
        doublings, rest = divmod(generation, self.first)
        doubled = rest == 0 and doublings > 0 and doublings & (doublings - 1) == 0
        return generation == 1 or doubled or self.epoch == 0

    def refreshed(self, archive: Elites, candidates: Elites, generation: int) -> "LearnedAxes":
        """Return the container with axes learned from elites and candidates, if it is time.

        With fewer rows than the number of axes plus two, the axes stay as they are.
        """
        if not self.changes(generation):
            return self
        rows = self._values(archive, candidates)
        if len(rows) < self.dimensions + 2:
            return self
        # `components` has a decomposition of its own: the bits of a library depend on the
        # processor.
        learned = vars(components.learn(rows, self.dimensions))
        arrays = {name: np.asarray(one, np.float32) for name, one in learned.items()}
        return self.with_arrays(arrays | {"epoch": np.int32(self.epoch + 1)})

    def arrays(self) -> Mapping[str, Any]:
        return {one.name: getattr(self.learned, one.name) for one in fields(self.learned)}

    def with_arrays(self, arrays: Mapping[str, Any]) -> "LearnedAxes":
        learned = {one.name: jnp.asarray(arrays[one.name]) for one in fields(self.learned)}
        return replace(self, learned=Learned(**learned))

    def _values(self, *parts: Elites) -> Float[np.ndarray, "row measure"]:
        """Return the measures of sound rows on their own scales, by generation and slot."""
        measures = np.concatenate([np.asarray(one.measures) for one in parts])
        fitness = np.concatenate([np.asarray(one.fitness) for one in parts])
        able = np.concatenate([np.asarray(one.occupied) for one in parts])
        born = [np.concatenate([np.asarray(one.generation) for one in parts])]
        born.insert(0, np.concatenate([np.asarray(one.slot) for one in parts]))
        descriptors = measures[:, [axis.measure for axis in self.axes]]
        able = able & np.isfinite(fitness) & np.all(np.isfinite(descriptors), 1)
        # Sums depend on the order of rows. The place of an elite has no meaning, its birth has.
        order = np.lexsort(born)
        order = order[able[order]]
        return components.scaled(measures[order][:, list(self.columns)], self.floors)


def learned_axes(
    cells: Cells,
    columns: tuple[int, ...],
    *,
    axes: int = 2,
    bins: int = 16,
    first: int = 10,
    floors: tuple[float, ...] = (),
) -> LearnedAxes:
    """Build a container that has learned nothing yet.

    `columns` are those of the measures of which axes are made, `floors` the least value of
    each that enters as a logarithm, 0 for one that does not. Raises `ValueError` for fewer
    measures than axes, for a measure twice, and for numbers beyond their bounds.
    """
    refuse_uncountable(1, axes=axes)
    refuse_uncountable(0, **{f"columns.{i}": column for i, column in enumerate(columns)})
    if len(set(columns)) < len(columns):
        raise InvalidField("columns", f"must be of different measures; got {columns}")
    if len(columns) < axes:
        raise ValueError(
            f"`columns` must be at least as many as `axes` ({axes}), got {columns}"
        )
    floors = floors or (0.0,) * len(columns)
    if len(floors) != len(columns):
        raise ValueError(f"`floors` must be as many as `columns`, got {floors} for {columns}")
    least: dict[str, Any] = {f"floors.{i}": floor for i, floor in enumerate(floors)}
    refuse_beyond(0, **least)
    size = len(columns)
    none = Learned(
        mean=zeros(np.float32, size),
        scale=zeros(np.float32, size),
        weights=zeros(np.float32, axes, size),
        explained=zeros(np.float32, axes),
        low=zeros(np.float32, axes),
        high=jnp.asarray(np.ones(axes, np.float32)),
        epoch=zeros(np.int32),
    )
    return LearnedAxes(cells, none, columns, floors, axes, bins, first)
