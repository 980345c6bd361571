"""Sphere, Rastrigin and arm with 100 genes: functions and published settings.

Linear projection: Fontaine et al., GECCO 2020, section 4; arm: Vassiliades and Mouret, GECCO
2018, in the form and with the settings of Fontaine and Nikolaidis, GECCO 2023.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp

GENES, BINS, BATCH, EMITTERS, RATE = 100, 100, 540, 15, 0.01
LIMIT, BEST = 5.12, 0.4 * 5.12
REACH = 4 * LIMIT
"""Bound of our genes on the scale of a task, which has none; so far that it hardly matters."""


@dataclass(frozen=True)
class Task:
    """A function of a vector, and each method's settings for it."""

    function: Callable[[jax.Array], tuple[jax.Array, jax.Array]]
    """Fitness, 100 at most, and two measures."""
    limit: float
    """Bound of both measures."""
    step: float
    """Initial deviation of CMA-MAE."""
    iso: float
    line: float = 0.2


def _projected(x: jax.Array) -> jax.Array:
    """Return sums of the first and of the second half; values beyond ±5.12 fold back."""
    beyond = jnp.abs(x) > LIMIT
    clipped = jnp.where(beyond, LIMIT / jnp.where(beyond, x, 1.0), x)
    return jnp.stack([jnp.sum(half) for half in jnp.split(clipped, 2)])


def _linear(value: Callable[[jax.Array], jax.Array]) -> Task:
    """Scale a function from 0 in the worst corner to 100 at the optimum."""

    def function(x: jax.Array) -> tuple[jax.Array, jax.Array]:
        worst = value(jnp.full(GENES, -LIMIT))
        return 100 * (1 - value(x) / worst), _projected(x)

    return Task(function, limit=LIMIT * GENES / 2, step=0.5, iso=0.5)


def _sphere(x: jax.Array) -> jax.Array:
    return jnp.sum((x - BEST) ** 2)


def _rastrigin(x: jax.Array) -> jax.Array:
    return jnp.sum(10 + (x - BEST) ** 2 - 10 * jnp.cos(2 * jnp.pi * (x - BEST)))


def _arm(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return fitness, best for even angles, and the place of the end of links of length 1."""
    angle = jnp.cumsum(x)
    end = jnp.stack([jnp.sum(jnp.cos(angle)), jnp.sum(jnp.sin(angle))])
    return 100 * (1 - jnp.var(x)), end


TASKS = {
    "sphere": _linear(_sphere),
    "Rastrigin": _linear(_rastrigin),
    "arm": Task(_arm, limit=float(GENES), step=0.1, iso=0.1),
}
