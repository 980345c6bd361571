"""Adam: steps by the mean of slopes over the root of the mean of their squares.

Kingma and Ba, ICLR 2015, algorithm 1, with its defaults.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-8

Slopes = Float[Array, "*block gene"]


class Adam(eqx.Module):
    """Moments of the slopes so far."""

    count: Int[Array, "*block"]
    mean: Slopes
    square: Slopes


def begin(genes: Float[Array, "gene"]) -> Adam:
    """Return the state before the first step."""
    none = jnp.zeros_like(genes)
    return Adam(jnp.zeros((), jnp.int32), none, none)


def descend(
    adam: Adam, slope: Float[Array, "gene"], rate: float | Float[Array, ""]
) -> tuple[Float[Array, "gene"], Adam]:
    """Return the descending change of genes, and the new state."""
    count = adam.count + 1
    mean = BETA_1 * adam.mean + (1 - BETA_1) * slope
    square = BETA_2 * adam.square + (1 - BETA_2) * slope * slope
    n = count.astype(slope.dtype)
    towards, spread = mean / (1 - BETA_1**n), square / (1 - BETA_2**n)
    return -rate * towards / (jnp.sqrt(spread) + EPSILON), Adam(count, mean, square)
