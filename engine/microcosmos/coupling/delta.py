"""Peskin's four-point delta and the transfer between nodes and cells.

Peskin, Acta Numerica 11, 479 (2002), eq. 6.27. Interpolation J and spreading S use the
same weights, so S is the transpose of J: what one body exerts, the fluid receives.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

Distances = Float[Array, "*shape"]
Vectors = Float[Array, "node 2"]
Plane = Float[Array, "x y"]

POINTS = 4


def peskin(r: Distances) -> Distances:
    """Peskin's four-point delta, zero beyond two cells."""
    r = jnp.abs(r)
    near, far = r < 1, (r >= 1) & (r < 2)
    a, b = jnp.where(near, r, 0.5), jnp.where(far, r, 1.5)  # Keep both roots positive.
    inner = (3 - 2 * a + jnp.sqrt(1 + 4 * a - 4 * a**2)) / 8
    outer = (5 - 2 * b - jnp.sqrt(-7 + 12 * b - 4 * b**2)) / 8
    return jnp.where(near, inner, jnp.where(far, outer, 0.0))


class Windows(eqx.Module):
    """The 4 × 4 cells around each node and their weights."""

    cells: Int[Array, "node 4 4"]
    """Cell numbers, x · height + y."""
    weights: Float[Array, "node 4 4"]


def windows(positions: Vectors, size: tuple[int, int]) -> Windows:
    """The cells that nodes act on in a periodic box of `size` cells."""
    base = jax.lax.stop_gradient(jnp.floor(positions)) - 1
    offsets = jnp.arange(POINTS, dtype=positions.dtype)
    cells = base[:, :, None] + offsets[None, None]
    weights = peskin(positions[:, :, None] - cells)
    x = jnp.mod(cells[:, 0], size[0]).astype(jnp.int32)
    y = jnp.mod(cells[:, 1], size[1]).astype(jnp.int32)
    return Windows(
        x[:, :, None] * size[1] + y[:, None, :],
        weights[:, 0, :, None] * weights[:, 1, None, :],
    )


def read(plane: Plane, at: Windows) -> Float[Array, "node 4 4"]:
    """The values of a plane in every window."""
    return plane.reshape(-1)[at.cells]


def spread(
    values: Float[Array, "node channel"], at: Windows, size: tuple[int, ...]
) -> Float[Array, "channel x y"]:
    """S: the density that values at nodes make in the cells."""
    amounts = values.T[:, :, None, None] * at.weights[None]
    planes = jnp.zeros((values.shape[1], size[0] * size[1]), values.dtype)
    planes = planes.at[:, at.cells].add(amounts, mode="promise_in_bounds")
    return planes.reshape(-1, *size)
