"""The written-out adjoint of a collision against automatic differentiation."""

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import fluid
from microcosmos.fluid.adjoint import collision


def test_the_adjoint_is_that_of_automatic_differentiation(float64):
    random = np.random.default_rng(0)

    def planes(count, size):
        return tuple(jnp.asarray(size * random.normal(size=(5, 7))) for _ in range(count))

    f, force = planes(9, 0.02), jnp.stack(planes(2, 1e-3))
    given = (f, fluid.density(f), fluid.momentum(f), force, fluid.rates(jnp.asarray(0.07)))
    cotangent = planes(9, 1.0)
    out, pull = jax.vjp(fluid.collide, *given)
    same, own = jax.vjp(collision, *given)
    for a, b in zip(same, out, strict=True):
        np.testing.assert_array_equal(a, b)
    expected, found = pull(cotangent), own(cotangent)
    assert jax.tree.structure(found) == jax.tree.structure(expected)
    for a, b in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12)
