"""Containers whose elites survive a competition of all, instead of one in each cell.

In every generation the elites and the candidates form one pool; a container says which of it
survive. A survivor keeps its place, newcomers take the free places in the total order. The
simplest is dominated novelty search (Bahlous-Boldi et al., GECCO 2025, arXiv:2502.00593).
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ...bounds import refuse_uncountable
from ..cells import Axis, Cells, places
from ..insertion import Elites, Inserted, ranked, sound


class Survival(eqx.Module):
    """A container of `count` places with at most one elite each; their numbers mean nothing.

    Figures are those of the best in each of `cells`, so that all containers compare.
    """

    cells: eqx.AbstractVar[Cells]

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of places."""

    @abstractmethod
    def survivors(self, pool: Elites, position: Int[Array, "row"]) -> Bool[Array, "row"]:
        """Return which rows of a pool survive, at most `count` of those that are `occupied`.

        `position` is each row's in the total order: distinct, the first is 0, rows that are not
        occupied come last. The result must not depend on the order of rows. The first `count`
        rows are the archive's, in the order of places.
        """

    @property
    def axes(self) -> tuple[Axis, ...]:
        return self.cells.axes

    def changes(self, generation: int) -> bool:
        """Return whether `refreshed` may change the container in this generation."""
        return False

    def refreshed(self, archive: Elites, candidates: Elites, generation: int) -> "Survival":
        """Return the container for the insertion of a generation, counted from 1."""
        return self

    def arrays(self) -> Mapping[str, Any]:
        """Return what the container has learned, for the archive file."""
        return {}

    def with_arrays(self, arrays: Mapping[str, Any]) -> "Survival":
        """Return the container with what `arrays` returned."""
        return self


def insert_survivors(
    archive: Elites, candidates: Elites, container: Survival
) -> tuple[Elites, Inserted]:
    """Return the archive with the survivors of archive and candidates; see `insert`.

    Among equal genotypes only the first in the total order may survive.
    """
    count, rows = container.count, len(candidates.occupied)
    able = sound(candidates, container.axes)
    pool = jax.tree.map(
        lambda old, new: jnp.concatenate([old, new]),
        archive,
        replace(candidates, occupied=able),
    )
    # Elites are ranked with the candidates, so the same creature again never takes two places.
    position, distinct = ranked(pool)
    pool = replace(pool, occupied=pool.occupied & distinct)
    kept = container.survivors(pool, position) & pool.occupied
    stays, entered = kept[:count], kept[count:]
    # The k-th newcomer in the total order takes the k-th free place.
    rank = _rank(jnp.where(entered, position[count:], count + rows))
    free = jnp.nonzero(~stays, size=count, fill_value=count)[0].astype(jnp.int32)
    place = jnp.where(entered, free[jnp.minimum(rank, count - 1)], count)
    home = jnp.minimum(place, count - 1)
    fresh = entered & ~archive.occupied[home]
    before = jnp.where(fresh, 0.0, archive.fitness[home])
    improvement = jnp.where(entered, candidates.fitness - before, -jnp.inf)
    # Rows that do not enter get distinct indices beyond the archive, which are dropped.
    to = jnp.where(entered, place, count + jnp.arange(rows))

    def placed(old, new):
        left = jnp.where(stays.reshape(-1, *[1] * (old.ndim - 1)), old, jnp.zeros_like(old))
        return left.at[to].set(new, mode="drop", unique_indices=True)

    filled = jax.tree.map(placed, archive, candidates)
    return filled, Inserted(place, entered, fresh, improvement)


def _rank(position: Int[Array, "row"]) -> Int[Array, "row"]:
    """Return the place of each row among the rows sorted by position."""
    order = jnp.argsort(position, stable=True)
    ranks = jnp.arange(len(position), dtype=jnp.int32)
    return jnp.zeros_like(ranks).at[order].set(ranks)


class DominatedNovelty(Survival):
    """The elites that are farthest from those that are fitter, wherever they lie."""

    cells: Cells
    size: int = eqx.field(static=True)
    """Most elites."""
    neighbours: int = eqx.field(static=True, default=3)
    """Fitter elites whose mean distance counts."""

    def __check_init__(self) -> None:
        refuse_uncountable(1, size=self.size, neighbours=self.neighbours)

    @property
    def count(self) -> int:
        return self.size

    def survivors(self, pool: Elites, position: Int[Array, "row"]) -> Bool[Array, "row"]:
        """Return the rows of the largest dominated novelty; the fitter of equal ones."""
        novelty = dominated_novelty(
            places(pool.measures, self.axes), pool.occupied, position, self.neighbours
        )
        order = jnp.lexsort((position, -novelty))
        best = jnp.zeros(len(novelty), bool).at[order[: self.size]].set(True)
        return best & pool.occupied


def dominated_novelty(
    place: Float[Array, "row axis"],
    occupied: Bool[Array, "row"],
    position: Int[Array, "row"],
    neighbours: int,
) -> Float[Array, "row"]:
    """Return the mean distance of each row to its nearest fitter ones.

    Distances are along the axes from 0 to 1 on their own scales. Fitter are the rows before it
    in the total order; without any the mean is infinite, with fewer than `neighbours` it is
    that of all. It is −∞ where rows are not occupied.
    """
    squares = jnp.zeros((len(place), len(place)), place.dtype)
    for axis in range(place.shape[1]):
        squares += (place[:, None, axis] - place[None, :, axis]) ** 2
    fitter = (position[None] < position[:, None]) & occupied[None]
    neighbours = min(neighbours, len(place))
    nearest = -jax.lax.top_k(jnp.where(fitter, -squares, -jnp.inf), neighbours)[0]
    counts, total = jnp.isfinite(nearest), jnp.zeros(len(place), place.dtype)
    for k in range(neighbours):  # In this order on every device.
        total += jnp.where(counts[:, k], jnp.sqrt(nearest[:, k]), 0.0)
    number = jnp.sum(counts, 1)
    novelty = jnp.where(number > 0, total / jnp.maximum(number, 1), jnp.inf)
    return jnp.where(occupied, novelty, -jnp.inf)
