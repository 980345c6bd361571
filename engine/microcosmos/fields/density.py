"""Density of nodes, each splatted onto the lattice as a Gaussian."""

import jax.numpy as jnp
from jaxtyping import Array, Float

Plane = Float[Array, "x y"]


def splat(positions: Float[Array, "node 2"], size: tuple[int, int], width: float) -> Plane:
    """Return the sum over nodes of exp(−r²/2σ²), σ = `width` cells, in a periodic box.

    Only the nearest image of each node counts, so the box must be many widths wide.
    """
    planes = []
    for axis, cells in enumerate(size):
        away = jnp.arange(cells, dtype=positions.dtype)[None] - positions[:, axis, None]
        away = away - cells * jnp.round(away / cells)
        planes.append(jnp.exp(-0.5 * (away / width) ** 2))
    return planes[0].T @ planes[1]


def saturated(density: Plane) -> Plane:
    """Return 1 − exp(−ρ): nodes that overlap count once, from 0 to 1."""
    return 1 - jnp.exp(-density)


def unsaturated(density: Plane) -> Plane:
    """Return the density itself."""
    return density
