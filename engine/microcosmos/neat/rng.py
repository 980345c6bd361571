"""Random numbers of one network, all drawn at once.

Separate draws for each decision would take most of a generation's time. So a key gives two
words, and pcg3d hashes them with each index (Jarzynski and Olano, J. Comput. Graph. Tech. 9(3),
20, 2020).
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray, UInt32

Uniform = Float[Array, "..."]
"""Numbers in [0, 1), multiples of 2⁻²⁴."""

LARGEST = 1 - 2.0**-24


def draws(*shapes: tuple[int, ...], key: PRNGKeyArray) -> list[Uniform]:
    """Draw independent numbers, one array per shape."""
    ends, end = [], 0
    for shape in shapes:
        end += math.prod(shape)
        ends.append(end)
    words = jax.random.bits(key, (2,), "uint32")
    hashed = pcg3d(words[0], words[1], jnp.arange(end, dtype=jnp.uint32))
    uniform = (hashed >> 8).astype(jnp.float32) * 2.0**-24
    parts = jnp.split(uniform, ends[:-1])
    return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]


def pcg3d(x: UInt32[Array, ""], y: UInt32[Array, ""], z: UInt32[Array, "place"]):
    """Return the third word of the hash of three words."""
    x, y, z = (jnp.uint32(1664525) * word + jnp.uint32(1013904223) for word in (x, y, z))
    x, y, z = _mixed(x, y, z)
    return _mixed(*(word ^ (word >> 16) for word in (x, y, z)))[2]


def rescaled(uniform: Uniform, low: float, high: float) -> Uniform:
    """Map a draw that fell between two thresholds to a new draw in [0, 1)."""
    return jnp.clip((uniform - low) / max(high - low, 2.0**-24), 0, LARGEST)


def below(total: Int[Array, "..."], uniform: Uniform) -> Int[Array, "..."]:
    """Return a whole number in [0, `total`), or 0 where `total` is 0."""
    most = jnp.maximum(0, total - 1)
    return jnp.minimum(jnp.floor(uniform * total).astype(most.dtype), most)


def _mixed(x, y, z):
    x = x + y * z
    y = y + z * x
    return x, y, z + x * y
