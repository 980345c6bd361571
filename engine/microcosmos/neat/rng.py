"""Random numbers of one network, all drawn at once.

Drawn for each decision by itself, they would take most of a generation's time. So a key
gives two words, which pcg3d stretches (Jarzynski and Olano, J. Comput. Graph. Tech. 9(3), 20,
2020): a hash of the two words and the place.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray, UInt32

Uniform = Float[Array, "..."]
"""Numbers from 0 on below 1, multiples of 2⁻²⁴."""

LARGEST = 1 - 2.0**-24


def draws(*shapes: tuple[int, ...], key: PRNGKeyArray) -> list[Uniform]:
    """Independent numbers, an array a shape."""
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
    """The third word of the hash of three words."""
    x, y, z = (jnp.uint32(1664525) * word + jnp.uint32(1013904223) for word in (x, y, z))
    x, y, z = _mixed(x, y, z)
    return _mixed(*(word ^ (word >> 16) for word in (x, y, z)))[2]


def left(uniform: Uniform, low: float, high: float) -> Uniform:
    """What a draw that fell between two thresholds leaves: a draw again."""
    return jnp.clip((uniform - low) / max(high - low, 2.0**-24), 0, LARGEST)


def below(total: Int[Array, "..."], uniform: Uniform) -> Int[Array, "..."]:
    """A whole number from 0 on below `total`, or 0 where that is 0."""
    most = jnp.maximum(0, total - 1)
    return jnp.minimum(jnp.floor(uniform * total).astype(most.dtype), most)


def _mixed(x, y, z):
    x = x + y * z
    y = y + z * x
    return x, y, z + x * y
