"""Waveforms: weighted sums of functions of the phase, one set of weights a joint or edge."""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

Phases = Float[Array, "time"]
Basis = Callable[[Phases, int], Float[Array, "time weight"]]
"""From phases in rad and a number of terms to what weights are multiplied by."""


def fourier(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Sines of the first harmonics, then cosines; no constant."""
    angle = phase[:, None] * jnp.arange(1, terms + 1, dtype=phase.dtype)[None]
    return jnp.concatenate([jnp.sin(angle), jnp.cos(angle)], 1)


def table(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Hats about `terms` times, evenly spaced over the period: linear interpolation."""
    place = (phase / (2 * np.pi) * terms)[:, None] - jnp.arange(terms, dtype=phase.dtype)[None]
    away = place - terms * jnp.round(place / terms)
    return jnp.maximum(0.0, 1 - jnp.abs(away))


def phases(timer: Array | np.ndarray, dtype) -> Phases:
    """The phase in rad of a sine and cosine (2, time), or of a linear timer (1, time)."""
    timer = jnp.asarray(timer, dtype)
    if len(timer) == 1:
        return 2 * np.pi * timer[0]
    return jnp.arctan2(timer[0], timer[1])


def wave(
    basis: Float[Array, "time weight"], weights: Float[Array, "gene"], items: int
) -> Float[Array, "time item"]:
    """What every item does over time, cut to ±1; its weights are side by side."""
    rows = weights.reshape(items, -1)
    return jnp.clip(jnp.sum(basis[:, None] * rows[None], 2), -1.0, 1.0)
