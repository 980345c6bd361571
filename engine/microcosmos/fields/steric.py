"""Steric repulsion: nodes move down the gradient of their own smoothed density.

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
from jaxtyping import Array, Float

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
    """Return the weights along a periodic axis by which `gaussian` smooths, and differentiates.

    In double precision: the sums of an inverse Fourier transform, wave by wave.
    """
    number = np.arange(cells)
    sine, cosine = (f(2 * np.pi * number / cells) for f in (exact.sine, exact.cosine))
    smooth, slope = np.zeros(cells), np.zeros(cells)
    for wave in range(-((cells - 1) // 2), cells // 2 + 1):
        k, phase = 2 * np.pi * wave / cells, wave * number % cells
        weight = exact.exponential(np.asarray(-0.5 * k * k)) / cells
        smooth += weight * cosine[phase]
        if 2 * wave != cells:
            slope -= weight * k * sine[phase]
    return np.stack([smooth, slope])


def binomial_weights(cells: int) -> np.ndarray:
    """Return the weights along a periodic axis by which `binomial` smooths, and its slope."""
    found = np.zeros((2, cells))
    for row, weights in zip(found, (SMOOTH, SLOPE), strict=True):
        for place, weight in enumerate(weights, -(len(weights) // 2)):
            row[-place % cells] += weight
    return found


WEIGHTS: dict[Callable[[Plane], Gradient], Callable[[int], np.ndarray]] = {
    gaussian: gaussian_weights,
    binomial: binomial_weights,
}
"""The weights of each gradient along an axis of a number of cells, by distance."""


def capped(displacement: Vectors, limit: Float[Array, ""]) -> Vectors:
    """Limit the length of each displacement; this changes their sum."""
    length = jnp.sqrt(jnp.sum(displacement * displacement, 1, keepdims=True) + 1e-24)
    return displacement * jnp.minimum(1.0, limit / length)


def _weighted(
    wide: Float[Array, "_ _"], weights: tuple[float, ...], axis: int
) -> Float[Array, "_ _"]:
    """Apply a stencil along an axis, which loses its margin of three cells."""
    first, length = 3 - len(weights) // 2, wide.shape[axis] - 6
    parts = [
        weight * jax.lax.slice_in_dim(wide, start, start + length, axis=axis)
        for start, weight in enumerate(weights, first)
    ]
    return sum(parts[1:], parts[0])
