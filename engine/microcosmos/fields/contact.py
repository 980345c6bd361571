"""Contact between bodies: the density of other bodies at each node, pair by pair.

A pair of nodes acts as on the lattice in `steric`: each is shared by the four cells around it,
and the density is smoothed by binomial weights. So two nodes more than five cells apart along
an axis add nothing, and what a body does to another it gets back.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .steric import SLOPE, SMOOTH

Vectors = Float[Array, "node 2"]
Pairs = Float[Array, "node node"]

REACH = 4
"""Most cells from a node's cell to that of another on which it acts."""
LEAST = 16
"""Fewest cells along an axis of a box in which bodies meet: of all images only the nearest
acts."""


class Contact(eqx.Module):
    """The strength of the repulsion between bodies."""

    strength: Float[Array, ""]
    """Displacement in a step per unit of gradient, cells³."""
    limit: Float[Array, ""]
    """The largest displacement in a step, cells: of a body's centre, and of its farthest node
    by rotation."""


class Density(eqx.Module):
    """The density of nodes at each node, and its gradient."""

    value: Float[Array, "node"]
    gradient: Vectors


def density(
    positions: Vectors, size: tuple[int, int], counted: Bool[Array, "node node"]
) -> Density:
    """Return the density of nodes at each node; `counted` says which (column) act on which
    (row)."""
    (smooth_x, slope_x), (smooth_y, slope_y) = (
        _along(positions[:, axis], size[axis]) for axis in (0, 1)
    )

    def total(pairs: Pairs) -> Float[Array, "node"]:
        return jnp.sum(jnp.where(counted, pairs, 0.0), 1)

    gradient = jnp.stack([total(slope_x * smooth_y), total(smooth_x * slope_y)], 1)
    return Density(total(smooth_x * smooth_y), gradient)


def touching(positions: Vectors, size: tuple[int, int]) -> Bool[Array, "node node"]:
    """Return which nodes act on each other."""
    (smooth_x, slope_x), (smooth_y, slope_y) = (
        _along(positions[:, axis], size[axis]) for axis in (0, 1)
    )
    # The gradient reaches a cell farther than the density.
    return (smooth_x * smooth_y > 0) | (slope_x * smooth_y != 0) | (smooth_x * slope_y != 0)


def _along(places: Float[Array, "node"], cells: int) -> tuple[Pairs, Pairs]:
    """Return the weights of smoothing and of the slope of all pairs along an axis."""
    cell = jnp.floor(places)
    share = places - cell
    away = cell[None] - cell[:, None]
    away = away - cells * jnp.round(away / cells)
    near = (jnp.abs(away) <= REACH)[None]
    at = jnp.clip(away, -REACH, REACH).astype(jnp.int32) + REACH + 1
    of, to = share[None], share[:, None]  # Of the node that acts, and of the one that reads.
    weights = []
    for table in _tables():
        rows = jnp.asarray(table, places.dtype)
        # A node that reads takes two cells, a node that acts gives to two.
        here = (1 - to) * rows[at] + to * rows[at - 1]
        next_one = (1 - to) * rows[at + 1] + to * rows[at]
        weights.append(jnp.where(near[0], (1 - of) * here + of * next_one, 0.0))
    return weights[0], weights[1]


def _tables() -> list[np.ndarray]:
    """Return both weights by cells from −REACH − 1 to REACH + 1."""
    tables = []
    for weights in (SMOOTH, SLOPE):
        table = np.zeros(2 * REACH + 3)
        first = REACH + 1 - len(weights) // 2
        table[first : first + len(weights)] = weights
        tables.append(table)
    return tables
