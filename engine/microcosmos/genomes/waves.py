"""Waveforms: weighted sums of functions of the phase, with weights per joint or edge."""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..portable import arctangent, cosine, sine

Phases = Float[Array, "time"]
Basis = Callable[[Phases, int], Float[Array, "time weight"]]
"""From phases in rad and a number of terms to the functions that weights multiply."""


def fourier(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Return sines of the first harmonics, then cosines, without a constant."""
    angle = phase[:, None] * jnp.arange(1, terms + 1, dtype=phase.dtype)[None]
    return jnp.concatenate([sine(angle), cosine(angle)], 1)


def table(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Return hat functions at `terms` times of the period, for linear interpolation."""
    place = (phase / (2 * np.pi) * terms)[:, None] - jnp.arange(terms, dtype=phase.dtype)[None]
    away = place - terms * jnp.round(place / terms)
    return jnp.maximum(0.0, 1 - jnp.abs(away))


def phases(timer: Array | np.ndarray, dtype) -> Phases:
    """Return the phase in rad of a sine and cosine (2, time) or a linear timer (1, time)."""
    timer = jnp.asarray(timer, dtype)
    if len(timer) == 1:
        return 2 * np.pi * timer[0]
    return arctangent(timer[0], timer[1])


def wave(
    basis: Float[Array, "time weight"], weights: Float[Array, "gene"], items: int
) -> Float[Array, "time item"]:
    """Return the waveform of every item, clipped to ±1; weights of an item are adjacent."""
    rows = weights.reshape(items, -1)
    return jnp.clip(jnp.sum(basis[:, None] * rows[None], 2), -1.0, 1.0)
