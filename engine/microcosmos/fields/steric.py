"""Repulsion: of bodies from each other, and from solid cells.

The method is the Microcosmos paper's: node positions are deposited on the grid, smoothed by
a Gaussian, and the gradient pushes nodes apart, without any search for neighbours. With the
same weights for depositing and for reading, a smoothing that is even and a gradient that is
odd, the displacements of all nodes sum to zero.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import scipy
from jaxtyping import Array, Bool, Float

from .. import exact

Plane = Float[Array, "x y"]
Gradient = Float[Array, "2 x y"]
Vectors = Float[Array, "node 2"]


SMOOTH = (1 / 16, 4 / 16, 6 / 16, 4 / 16, 1 / 16)
SLOPE = (-1 / 32, -4 / 32, -5 / 32, 0.0, 5 / 32, 4 / 32, 1 / 32)
"""Binomial weights, and half the difference of those a cell behind and a cell ahead."""


class Steric(eqx.Module):
    """The strength and form of the repulsion between nodes."""

    strength: Float[Array, ""]
    """Displacement in a step per unit of gradient, cells³."""
    limit: Float[Array, ""]
    """The largest displacement in a step, cells."""
    gradient: Callable[[Plane], Gradient] = eqx.field(static=True)
    """`gaussian` or `binomial`: the gradient of the smoothed density."""


def gaussian(density: Plane) -> Gradient:
    """Smooth by a Gaussian of width one cell and differentiate, both by Fourier transform."""
    size = density.shape
    kx = 2 * jnp.pi * jnp.fft.fftfreq(size[0], dtype=density.dtype)[:, None]
    ky = 2 * jnp.pi * jnp.fft.rfftfreq(size[1], dtype=density.dtype)[None]
    smooth = jnp.fft.rfft2(density) * jnp.exp(-0.5 * (kx * kx + ky * ky))
    # The Nyquist wave has no sign: its derivative is zero.
    waves = [jnp.where(jnp.abs(k) > 3.14159, 0.0, k) for k in (kx, ky)]
    return jnp.stack([jnp.fft.irfft2(1j * k * smooth, size) for k in waves])


def binomial(density: Plane) -> Gradient:
    """Smooth by binomial weights of the same variance and differentiate, without a transform.

    Between lines one cell apart the gradient is 5/32 (the Gaussian's: 0.24); from two cells on
    it is larger than the Gaussian's.
    """
    wide = jnp.pad(density, 3, mode="wrap")
    return jnp.stack(
        [
            _weighted(_weighted(wide, SMOOTH, 1), SLOPE, 0),
            _weighted(_weighted(wide, SMOOTH, 0), SLOPE, 1),
        ]
    )


def gaussian_weights(cells: int) -> np.ndarray:
    """Return the weights of `gaussian` along a periodic axis, for the native kernel.

    The result, (2, cell), has the weights of smoothing, then those of the slope, by distance.
    They are the inverse Fourier transform in double precision, added wave by wave.
    """
    number = np.arange(cells)
    # Phases are whole multiples of a turn over `cells`, so one table serves every wave.
    sine, cosine = (f(2 * np.pi * number / cells) for f in (exact.sine, exact.cosine))
    smooth, slope = np.zeros(cells), np.zeros(cells)
    for wave in range(-((cells - 1) // 2), cells // 2 + 1):
        k, phase = 2 * np.pi * wave / cells, wave * number % cells
        weight = exact.exponential(np.asarray(-0.5 * k * k)) / cells
        smooth += weight * cosine[phase]
        if 2 * wave != cells:  # The Nyquist wave has no slope, as in `gaussian`.
            slope -= weight * k * sine[phase]
    return np.stack([smooth, slope])


def binomial_weights(cells: int) -> np.ndarray:
    """Return the weights of `binomial` along a periodic axis, in the form of those above."""
    table = np.zeros((2, cells))
    for row, weights in zip(table, (SMOOTH, SLOPE), strict=True):
        for place, weight in enumerate(weights, -(len(weights) // 2)):
            row[-place % cells] += weight  # In a narrow box several places are one cell.
    return table


WEIGHTS: dict[Callable[[Plane], Gradient], Callable[[int], np.ndarray]] = {
    gaussian: gaussian_weights,
    binomial: binomial_weights,
}
"""Functions that return the weights of each gradient along an axis of so many cells."""


def capped(displacement: Vectors, limit: Float[Array, ""]) -> Vectors:
    """Limit the length of each displacement; this changes their sum."""
    # The constant keeps the root differentiable for a node that is not displaced.
    length = jnp.sqrt(jnp.sum(displacement * displacement, 1, keepdims=True) + 1e-24)
    return displacement * jnp.minimum(1.0, limit / length)


def _weighted(
    wide: Float[Array, "_ _"], weights: tuple[float, ...], axis: int
) -> Float[Array, "_ _"]:
    """Apply a stencil along an axis; the result lacks the margin of three cells at each end."""
    first, length = 3 - len(weights) // 2, wide.shape[axis] - 6
    parts = [
        weight * jax.lax.slice_in_dim(wide, start, start + length, axis=axis)
        for start, weight in enumerate(weights, first)
    ]
    return sum(parts[1:], parts[0])


def splat(positions: Float[Array, "node 2"], size: tuple[int, int], width: float) -> Plane:
    """Return the sum over nodes of exp(−r²/2σ²), σ = `width` cells, in a periodic box.

    Only the nearest image of each node counts, so the box must be many widths wide.
    """
    # A Gaussian is a product of one along x and one along y: the sum over nodes is a product of
    # two matrices, (x, node) and (node, y), and no plane for each node is formed.
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


REACH = 1.5
"""Distance from the surface within which nodes are moved, in cells."""
LIMIT = 0.1
"""The largest displacement of a body in a step, in cells."""
MARGIN = 16
"""Cells beyond an edge of the periodic box that count for distances."""


class Barrier(eqx.Module):
    """Displacements of nodes near solid cells."""

    away: Float[Array, "2 x y"]
    """Displacement in a step, in cells."""
    limit: Float[Array, ""]
    """The largest displacement of a body in a step, in cells."""


def away(solid: Bool[np.ndarray, "x y"]) -> Float[np.ndarray, "2 x y"]:
    """Return displacements of one cell per cell of depth below `REACH`, along the normal.

    They are the gradient of half the square of the depth, by central differences: mirror
    images of a solid have mirror images of these. The surface lies half a cell outside the
    solid cells; deep inside a solid the depth is that below the nearest surface.
    """
    # SciPy's distances know no period: images of the solid cells stand beyond every edge.
    wide = np.pad(solid, MARGIN, mode="wrap")
    outside, inside = (
        np.asarray(scipy.ndimage.distance_transform_edt(one)) for one in (~wide, wide)
    )
    # Distances are between centres of cells; the surface is half a cell from each.
    height = np.where(wide, 0.5 - inside, outside - 0.5)
    potential = 0.5 * np.maximum(REACH - height, 0) ** 2
    kept = slice(MARGIN, -MARGIN)
    slopes = [np.gradient(potential, axis=axis)[kept, kept] for axis in (0, 1)]
    return -np.stack(slopes)
