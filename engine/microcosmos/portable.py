"""Arithmetic whose bits are the same on every processor, with the flags of `device`.

XLA leaves matrix products to libraries, which split sums as a processor likes, turns x / √y
into a product with a reciprocal root, which processors approximate differently, and takes sine,
cosine, arctangent and powers from the C library, whose versions round differently. In double
precision, which no search uses, the functions are JAX's.
"""

import jax
import jax.numpy as jnp
from jax.lax import optimization_barrier
from jaxtyping import Array, Float, Int

TURNS = 1011.5928344726562
"""161 turns in rad: of the first 400 multiples of a turn the nearest to a float32."""
EXCESS = 1.67427e-8
"""Excess of `TURNS` over 161 turns, in rad."""
QUARTER = 1.5703125, 4.8375129699707031e-4, 7.54978995489188216e-8
"""A quarter turn in three parts, of which small multiples are exact (Cody and Waite)."""


def product(
    one: Float[Array, "row item"], other: Float[Array, "item column"]
) -> Float[Array, "row column"]:
    """Return the product of two matrices, as written-out sums."""
    # `matmul` would go to a library, which splits sums as the processor likes.
    return jnp.sum(one[:, :, None] * other[None], 1)


@jax.jit
def long_product(
    one: Float[Array, "row item"], other: Float[Array, "item column"]
) -> Float[Array, "row column"]:
    """Return the product of two matrices, one item after another: fast where there are many."""

    def add(total, pair):
        return total + pair[0][:, None] * pair[1][None], None

    none = jnp.zeros((one.shape[0], other.shape[1]), one.dtype)
    return jax.lax.scan(add, none, (one.T, other))[0]


def root(x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the square root in a form by which values may be divided."""
    # The barrier keeps XLA from turning x / √y into x times an approximate reciprocal root.
    return optimization_barrier(jnp.sqrt(x))


def power(base: float, exponent: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return a power of a base that is not negative; x⁰ = 1 also for x = 0."""
    # XLA takes `pow` from the C library, but has programs of its own for both of these.
    value = jnp.exp(exponent * jnp.log(jnp.asarray(base, exponent.dtype)))
    return jnp.where(exponent == 0, 1.0, value)


@jax.custom_jvp
def sine(x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the sine of angles in rad."""
    if x.dtype != jnp.float32:
        return jnp.sin(x)
    rest, quarters = _reduced(x)
    return _of_quarter(rest, quarters)


@jax.custom_jvp
def cosine(x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the cosine of angles in rad."""
    if x.dtype != jnp.float32:
        return jnp.cos(x)
    rest, quarters = _reduced(x)
    return _of_quarter(rest, quarters + 1)


sine.defjvps(lambda tangent, value, x: cosine(x) * tangent)
cosine.defjvps(lambda tangent, value, x: -sine(x) * tangent)


@jax.custom_jvp
def arctangent(y: Float[Array, "*shape"], x: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the angle of (x, y) in rad; 0 or π at the origin."""
    if x.dtype != jnp.float32:
        return jnp.arctan2(y, x)
    wide, high = jnp.abs(x), jnp.abs(y)
    longest = jnp.maximum(wide, high)
    slope = jnp.minimum(wide, high) / jnp.where(longest > 0, longest, 1.0)
    steep = slope > 0.41421356  # The polynomial of Cephes reaches to an eighth of π.
    u = jnp.where(steep, (slope - 1) / (slope + 1), slope)
    z = u * u
    p = (8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1
    angle = (p * z - 3.33329491539e-1) * z * u + u
    angle = jnp.where(steep, angle + 0.78539816, angle)
    angle = jnp.where(high > wide, 1.5707963 - angle, angle)
    # By the sign bit, not by x < 0: −0 has an angle of π, as in the C library.
    angle = jnp.where(jnp.signbit(x), 3.1415927 - angle, angle)
    return jnp.where(jnp.signbit(y), -angle, angle)


arctangent.defjvps(
    lambda tangent, value, y, x: x / (x * x + y * y) * tangent,
    lambda tangent, value, y, x: -y / (x * x + y * y) * tangent,
)


def _reduced(
    x: Float[Array, "*shape"],
) -> tuple[Float[Array, "*shape"], Int[Array, "*shape"]]:
    """Return angles within an eighth of a turn, and the quarter turns taken off."""
    # The remainder is exact, so that large angles lose only the excess of `TURNS`.
    near = jax.lax.rem(x, jnp.full_like(x, TURNS))
    quarters = jnp.round(near * 0.63661977)
    # Beyond 6 · 10⁹ rad a float32 is no angle; the bound keeps the polynomial in its range.
    excess = jnp.clip(jnp.round((x - near) / TURNS) * EXCESS, -0.1, 0.1)
    for part in QUARTER:
        near = near - quarters * part
    return near + excess, quarters.astype(jnp.int32)


def _of_quarter(
    rest: Float[Array, "*shape"], quarters: Int[Array, "*shape"]
) -> Float[Array, "*shape"]:
    """Return the sine of a small angle and quarter turns, by the polynomials of Cephes."""
    z = rest * rest
    s = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * rest + rest
    c = (2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2
    c = c * z * z - 0.5 * z + 1.0
    value = jnp.where(quarters & 1, c, s)
    return jnp.where(quarters & 2, -value, value)
