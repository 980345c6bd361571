"""Two bodies side by side push each other away without pushing the fluid."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fields, world

from . import scenes
from .precision import Precision, precision
from .rows import Found, at_least, at_most


def apart(
    dtype: Any, *, gap: float = 1.0, steps: int = 300, viscosity: float = 0.3
) -> tuple[float, float]:
    """The gap between two parallel chains at the end, and the largest net force of either."""
    one = bodies.chain(20, 1.0)
    pair = bodies.together(
        [bodies.placed(one, (0.0, y)) for y in (-0.5 * gap, 0.5 * gap)],
    )
    steric = fields.Steric(
        strength=jnp.asarray(4.0, dtype),
        limit=jnp.asarray(0.1, dtype),
        gradient=fields.gaussian,
    )
    box, start = scenes.immersed(
        pair, viscosity, dtype, steric=steric, limits=scenes.limits(viscosity, dtype)
    )
    rest = scenes.held(pair, steps, dtype)
    end, forces = jax.jit(
        lambda: world.rollout(box, start, rest, lambda _, measures: measures.force)
    )()
    y = np.asarray(end.positions, float)[:, 1]
    largest = np.max(np.abs(np.asarray(forces, float)))
    return float(y[20:].mean() - y[:20].mean()), float(largest)


def check(steps: int = 300, name: Precision = "float32") -> Found:
    with precision(name) as dtype:
        gap, force = apart(dtype, steps=steps)
    what = f"two bodies a cell apart, after {steps} steps"
    return Found(
        [
            at_least(f"{what}: gap (cells)", gap, 3.0, 4.0, "reach of the repulsion"),
            at_most(f"{what}: sum of forces of either", force, 1e-6, "Newton's third law"),
        ]
    )
