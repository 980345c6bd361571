"""Arithmetic whose bits are the same on every processor: XLA may not rewrite it.

XLA makes matrix products of sums of products, which libraries split as a processor likes, and
reciprocal roots of x / √y, which processors approximate differently.
"""

import jax.numpy as jnp
from jax.lax import optimization_barrier
from jaxtyping import Array, Float


def product(
    one: Float[Array, "row item"], other: Float[Array, "item column"]
) -> Float[Array, "row column"]:
    """Return the product of two matrices."""
    return jnp.sum(optimization_barrier(one[:, :, None] * other[None]), 1)


def root(x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the square root, by which others may be divided."""
    return optimization_barrier(jnp.sqrt(x))
