"""Tortuosity: how far the middle of a body travels for the distance it gets."""

from typing import Any

from ..declaration import descriptor

STANDSTILL = 1e-6
"""Path in cells below which a body counts as at rest."""


@descriptor("tortuosity", title="Tortuosity", low=1.0, high=1e3, scale="log10")
def tortuosity(motion: Any) -> Any:
    """Length of the path of the body's middle node / its displacement: 1 along a straight line
    and at rest, at most 1,000."""
    import jax.numpy as jnp

    steps = jnp.diff(motion.middle, axis=0)
    path = jnp.sum(jnp.sqrt(jnp.sum(steps * steps, -1) + 1e-24))
    way = motion.middle[-1] - motion.middle[0]
    displacement = jnp.sqrt(jnp.sum(way * way) + 1e-24)
    # A closed path has no displacement to divide by, a body at rest has no path either.
    least = jnp.maximum(1e-3 * path, STANDSTILL)
    return jnp.maximum(path, STANDSTILL) / jnp.maximum(displacement, least)
