"""Random controllers: whatever they ask for, the world stays finite."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, world

from . import scenes
from .precision import precision
from .rows import Found, at_least

SOUND = 3**-0.5
"""Cells a step."""

VISCOSITIES = (0.001, 0.003, 0.01, 0.05, 0.3, 2.0)


@jax.jit
def _lives(box, start, rests):
    def lives(rest):
        end, _ = world.rollout(box, start, rest)
        speed = jnp.sqrt(jnp.max(jnp.sum(world.flow(box, end) ** 2, 0)))
        whole = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(end)]
        return jnp.all(jnp.stack(whole)) & (speed < SOUND)

    return jax.lax.map(lives, rests)


def survivors(viscosity: float, seeds: int, steps: int, dtype: Any) -> int:
    """How many of `seeds` random controllers leave everything finite and below sound."""
    body = bodies.chain(32, 1.0)
    limits = scenes.limits(viscosity, dtype)
    box, start = scenes.immersed(body, viscosity, dtype, limits=limits)
    rests = [scenes.erratic(body, steps, dtype, seed) for seed in range(seeds)]
    return int(np.sum(_lives(box, start, jax.tree.map(lambda *x: jnp.stack(x), *rests))))


def check(
    viscosities: tuple[float, ...] = VISCOSITIES, seeds: int = 10, steps: int = 3000
) -> Found:
    rows = []
    for viscosity in viscosities:
        with precision("float32") as dtype:
            count = survivors(viscosity, seeds, steps, dtype)
        what = f"random controllers finite over {steps:,} steps, ν {viscosity:g}"
        rows.append(at_least(what, count, seeds, seeds, f"all {seeds} seeds"))
    return Found(rows)
