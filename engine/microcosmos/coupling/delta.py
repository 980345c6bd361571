"""Regularised deltas and the transfer between points and cells.

Interpolation J and spreading S use the same weights, so S is the transpose of J: the
fluid receives what bodies exert. Transfers work on chunks of points, so that temporaries stay
in cache and do not grow with the number of points.
"""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

Distances = Float[Array, "*shape"]
Vectors = Float[Array, "node 2"]
Plane = Float[Array, "x y"]

CHUNK = 2**13
"""Points in a chunk. Measured: temporaries of larger chunks leave the cache."""


@dataclass(frozen=True)
class Kernel:
    """A delta in one dimension over `points` cells; it is zero beyond half of them."""

    weight: Callable[[Distances], Distances]
    points: int


def peskin(r: Distances) -> Distances:
    """Weight by Peskin's four-point delta (Acta Numerica 11, 479, 2002, eq. 6.27)."""
    r = jnp.abs(r)
    near, far = r < 1, (r >= 1) & (r < 2)
    a, b = jnp.where(near, r, 0.5), jnp.where(far, r, 1.5)  # Keep both roots positive.
    inner = (3 - 2 * a + jnp.sqrt(1 + 4 * a - 4 * a**2)) / 8
    outer = (5 - 2 * b - jnp.sqrt(-7 + 12 * b - 4 * b**2)) / 8
    return jnp.where(near, inner, jnp.where(far, outer, 0.0))


def roma(r: Distances) -> Distances:
    """Weight by the three-point delta of Roma, Peskin and Berger (1999)."""
    r = jnp.abs(r)
    near, far = r < 0.5, (r >= 0.5) & (r < 1.5)
    a = jnp.where(near, r, jnp.where(far, 1 - r, 0.0))  # Keep the root positive.
    root = jnp.sqrt(1 - 3 * a**2)
    return jnp.where(near, (1 + root) / 3, jnp.where(far, (5 - 3 * r - root) / 6, 0.0))


def hat(r: Distances) -> Distances:
    """Weight by linear interpolation."""
    return jnp.maximum(1 - jnp.abs(r), 0.0)


PESKIN, ROMA, HAT = Kernel(peskin, 4), Kernel(roma, 3), Kernel(hat, 2)


class Windows(eqx.Module):
    """The cells around each point and their weights, in chunks of points."""

    cells: Int[Array, "chunk row p p"]
    """Cell numbers, x · height + y."""
    weights: Float[Array, "chunk row p p"]
    """Zero for the points that fill up the last chunk."""
    points: int = eqx.field(static=True)
    density: Float[Array, "cell"] | None = None
    """Divisor of planes when they are read; None: 1."""

    def chunks(self, values: Float[Array, "node channel"]) -> Float[Array, "chunk row channel"]:
        """Divide values at points into the same chunks."""
        chunks, rows = self.cells.shape[:2]
        filled = jnp.pad(values, ((0, chunks * rows - self.points), (0, 0)))
        return filled.reshape(chunks, rows, -1)


def windows(positions: Vectors, size: tuple[int, ...], kernel: Kernel = PESKIN) -> Windows:
    """Return the cells of a periodic box of `size` cells on which points act, with weights.

    `positions` are in cells, and may be beyond the box.
    """
    points = len(positions)
    if points <= CHUNK:
        cells, weights = _around(positions, size, kernel)
        return Windows(cells[None], weights[None], points)
    chunks = -(-points // CHUNK)
    filled = jnp.pad(positions, ((0, chunks * CHUNK - points), (0, 0)))
    cells, weights = jax.lax.map(
        lambda part: _around(part, size, kernel), filled.reshape(chunks, CHUNK, 2)
    )
    # The points that fill up the last chunk stand at 0: without weight they act on no cell.
    real = jnp.arange(chunks * CHUNK).reshape(chunks, CHUNK) < points
    return Windows(cells, jnp.where(real[:, :, None, None], weights, 0.0), points)


def interpolate(
    planes: tuple[Plane, ...] | Float[Array, "channel x y"], at: Windows
) -> Float[Array, "node channel"]:
    """Return the values of planes at points (J), (node, channel)."""
    flat = [plane.reshape(-1) for plane in planes]
    if at.density is not None:
        flat = [plane / at.density for plane in flat]

    def read(chunk):
        cells, weights = chunk
        return jnp.stack([jnp.sum(weights * plane[cells], (1, 2)) for plane in flat], 1)

    if len(at.cells) == 1:
        return read((at.cells[0], at.weights[0]))
    values = jax.lax.map(read, (at.cells, at.weights))
    return values.reshape(-1, len(flat))[: at.points]


def spread(
    values: Float[Array, "node channel"], at: Windows, size: tuple[int, ...]
) -> Float[Array, "channel x y"]:
    """Return the planes onto which values at points are spread (S), (channel, x, y).

    Each plane has the sum of its values: weights of a point sum to 1.
    """
    planes = jnp.zeros((values.shape[1], size[0] * size[1]), values.dtype)

    def add(planes, chunk):
        values, cells, weights = chunk
        # `_around` has put every cell into the box, so no index has to be checked.
        amounts = values.T[:, :, None, None] * weights[None]
        return planes.at[:, cells].add(amounts, mode="promise_in_bounds"), None

    if len(at.cells) == 1:
        planes, _ = add(planes, (values, at.cells[0], at.weights[0]))
    else:
        planes, _ = jax.lax.scan(add, planes, (at.chunks(values), at.cells, at.weights))
    return planes.reshape(-1, *size)


def divided(at: Windows, plane: Plane) -> Windows:
    """Return windows that interpolate planes divided by `plane`, J (p/ρ)."""
    density = plane.reshape(-1)
    # The weights of one chunk are divided, once for all planes. Many chunks would need a second
    # array of weights, so `interpolate` divides the planes instead.
    if len(at.cells) == 1:
        return Windows(at.cells, at.weights / density[at.cells], at.points)
    return Windows(at.cells, at.weights, at.points, density)


def masked(at: Windows, present: Bool[Array, "node"] | None) -> Windows:
    """Empty the windows of absent points."""
    if present is None:
        return at
    real = at.chunks(present.astype(at.weights.dtype)[:, None])
    weights = jnp.where(real[:, :, :, None] > 0, at.weights, 0.0)
    return Windows(at.cells, weights, at.points, at.density)


def _around(positions, size, kernel):
    first = kernel.points / 2 - 1
    # Cells do not move with a point; only its weights have a derivative.
    base = jax.lax.stop_gradient(jnp.floor(positions - first))
    offsets = jnp.arange(kernel.points, dtype=positions.dtype)
    cells = base[:, :, None] + offsets[None, None]
    # Distances are of unwrapped cells: a window across the border needs no nearest image.
    weights = kernel.weight(positions[:, :, None] - cells)
    x = jnp.mod(cells[:, 0], size[0]).astype(jnp.int32)
    y = jnp.mod(cells[:, 1], size[1]).astype(jnp.int32)
    numbers = x[:, :, None] * size[1] + y[:, None, :]
    return numbers, weights[:, 0, :, None] * weights[:, 1, None, :]
