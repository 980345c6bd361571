"""The native kernel in random worlds: as exact as JAX in single precision."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import OBSERVED, any_scene, in_jax, run

from microcosmos import world

pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native


@pytest.mark.long
@pytest.mark.parametrize("seed", range(40))
def test_the_kernel_is_as_exact_as_jax_in_any_world(seed):
    """Rounding grows in some worlds: errors are those against JAX in double precision."""
    box, start, rest = any_scene(np.random.default_rng(seed))
    end, observed = run(in_jax, (box, start, rest))
    found, seen = run(native.rollout, (box, start, rest))
    with jax.enable_x64(True):
        double = jax.tree.map(_double, (box, start, rest))
        exact_end, exact = run(in_jax, double)
    for one in (*OBSERVED, "positions"):
        expected = np.asarray(getattr(exact, one))
        floor = 1e-5 + 2e-4 * np.abs(expected).max(initial=0)
        for steps in (1, 10, 100):
            ours, theirs = (
                np.abs(np.asarray(getattr(x, one))[:steps] - expected[:steps]).max()
                for x in (seen, observed)
            )
            assert ours <= 4 * theirs + floor, (one, steps)
    np.testing.assert_allclose(
        found.populations, exact_end.populations, atol=4 * _far(end, exact_end) + 3e-5
    )


def _double(x):
    return jnp.asarray(x, jnp.float64) if eqx.is_inexact_array(x) else x


def _far(one, other):
    pairs = zip(one.populations, other.populations, strict=True)
    return max(np.abs(np.asarray(x) - np.asarray(y)).max() for x, y in pairs)
