"""What a fluid keeps over many steps: mass, and momentum where nothing pushes it."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from microcosmos import fluid

from .flows import after
from .precision import Precision, precision
from .rows import Found, at_most


def drift(
    viscosity: float, dtype: Any, *, size: tuple[int, int] = (64, 64), steps: int = 10_000
) -> tuple[float, float]:
    """Relative drift of mass, and of momentum against cells times speed, from random flow."""
    random, speed = np.random.default_rng(0), 0.01
    f = tuple(jnp.asarray(random.uniform(-speed, speed, size), dtype) for _ in range(9))
    rates = fluid.rates(jnp.asarray(viscosity, dtype))
    force = jnp.zeros((2, *size), dtype)
    end = after(f, steps, rates, force, fluid.Surroundings())
    mass = [np.sum(np.asarray(fluid.density(g), float)) for g in (f, end)]
    momentum = [np.sum(np.asarray(fluid.momentum(g), float), (1, 2)) for g in (f, end)]
    cells = size[0] * size[1]
    return (
        float(abs(mass[1] - mass[0]) / mass[0]),
        float(np.max(np.abs(momentum[1] - momentum[0])) / (cells * speed)),
    )


def check(
    viscosities: tuple[float, ...] = (0.01, 0.1, 2.0),
    size: tuple[int, int] = (64, 64),
    steps: int = 10_000,
    name: Precision = "float32",
) -> Found:
    rows, law = [], "conservation"
    for viscosity in viscosities:
        with precision(name) as dtype:
            mass, momentum = drift(viscosity, dtype, size=size, steps=steps)
        after_steps = f"after {steps:,} steps, ν {viscosity:g}"
        rows.append(at_most(f"drift of mass {after_steps}", mass, 1e-6, law))
        rows.append(at_most(f"drift of momentum {after_steps}", momentum, 1e-4, law))
    return Found(rows)
