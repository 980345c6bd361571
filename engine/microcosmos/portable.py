"""Arithmetic whose bits are the same on every processor, with the flags of `device.PORTABLE`.

XLA leaves matrix products to libraries, which split sums as a processor likes, and turns x / √y
into a product with a reciprocal root, which processors approximate differently.
"""

import jax.numpy as jnp
from jax.lax import optimization_barrier
from jaxtyping import Array, Float


def product(
    one: Float[Array, "row item"], other: Float[Array, "item column"]
) -> Float[Array, "row column"]:
    """Return the product of two matrices, as written-out sums."""
    return jnp.sum(one[:, :, None] * other[None], 1)


def root(x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the square root, by which others may be divided."""
    return optimization_barrier(jnp.sqrt(x))
