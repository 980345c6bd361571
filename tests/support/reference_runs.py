"""What JAX finds of a creature in double precision, and with numbers that differ by rounding.

A creature is a named tuple whose `actuator` are genes, or the rest shapes of a gait.
`simulated` takes one and the kernel's name.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

SAMPLES = 3
"""Evaluations by JAX from which its error is taken: of one, the error of a quantity of few
numbers may be near 0 by chance, as that of the packets' four numbers was on one processor."""


def exact(creature, simulated):
    """Return what JAX finds with the same numbers in double precision."""
    with jax.enable_x64(True):
        double = jax.tree.map(
            lambda x: jnp.asarray(x, jnp.float64) if eqx.is_inexact_array(x) else x, creature
        )
        return simulated(double, "jax")


def samples(creature, simulated):
    """Return what JAX finds with genes, or a gait's rest shapes, that differ by rounding."""
    rng = np.random.default_rng(0)

    def nudged(x):
        off = rng.choice([-1, 0, 1], x.shape) * np.finfo(np.float32).eps
        return jnp.asarray(np.asarray(x) * (1 + off), x.dtype)

    inexact, rest = eqx.partition(creature.actuator, eqx.is_inexact_array)
    genes = [eqx.combine(jax.tree.map(nudged, inexact), rest) for _ in range(SAMPLES - 1)]
    return [simulated(creature._replace(actuator=one), "jax") for one in genes]
