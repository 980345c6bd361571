"""Dominated novelty search (Bahlous-Boldi et al., GECCO 2025, arXiv:2502.00593)."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..cells import Cells, places
from ..insertion import Elites
from .survival import Survival


class DominatedNovelty(Survival):
    """The elites that are farthest from those that are fitter, wherever they lie."""

    cells: Cells
    size: int = eqx.field(static=True)
    """Most elites."""
    neighbours: int = eqx.field(static=True, default=3)
    """Fitter elites whose mean distance counts."""

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
    nearest = -jax.lax.top_k(jnp.where(fitter, -squares, -jnp.inf), neighbours)[0]
    there, total = jnp.isfinite(nearest), jnp.zeros(len(place), place.dtype)
    for k in range(neighbours):  # In this order on every device.
        total += jnp.where(there[:, k], jnp.sqrt(nearest[:, k]), 0.0)
    number = jnp.sum(there, 1)
    novelty = jnp.where(number > 0, total / jnp.maximum(number, 1), jnp.inf)
    return jnp.where(occupied, novelty, -jnp.inf)
