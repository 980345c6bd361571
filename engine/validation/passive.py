"""Bodies that keep their shape in a shear flow: they turn with it.

A circle turns with half of the shear; a rod as G. B. Jeffery, Proc. R. Soc. A 102, 161
(1922), says of a slender one: tan of its angle grows with the shear.
"""

from dataclasses import replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fluid

from . import scenes
from .precision import Precision, precision
from .rows import Found, between, close

JEFFERY = "Jeffery 1922"
SIZE = (64, 64)


def rotation(positions: np.ndarray) -> float:
    """By how much a body turned as a whole, anticlockwise, in radians."""
    arms = positions - positions.mean(1, keepdims=True)
    a, b = arms[:-1], arms[1:]
    sine = np.sum(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], 1)
    return float(np.sum(np.arctan2(sine, np.sum(a * b, (1, 2)))))


def turned(
    body: bodies.Body,
    dtype: Any,
    *,
    steps: int = 500,
    viscosity: float = 0.05,
    speed: float = 0.02,
    **options: Any,
) -> tuple[float, float]:
    """How far a body turned in a decaying sine flow, and the shear integrated over time.

    The body is where the flow is still and its shear strongest.
    """
    box, start = scenes.immersed(body, viscosity, dtype, size=SIZE, **options)
    k = 2 * np.pi / SIZE[1]
    wave = np.tile(speed * np.sin(k * (np.arange(SIZE[1]) - SIZE[1] / 2)), (SIZE[0], 1))
    u = jnp.asarray(np.stack([wave, np.zeros(SIZE)]), dtype)
    start = replace(start, populations=fluid.equilibrium(jnp.ones(SIZE, dtype), u))
    positions = scenes.recorded(box, start, scenes.held(body, steps, dtype))
    decay = np.exp(-viscosity * k**2 * np.arange(steps))
    return rotation(positions), float(speed * k * np.sum(decay))


def ring_rate(dtype: Any, nodes: int = 28, **options: Any) -> float:
    """Of a ring, over half of the shear."""
    angle, shear = turned(bodies.ring(nodes, 1.0), dtype, **options)
    return -angle / (0.5 * shear)


def rod_turn(dtype: Any, nodes: int = 12, **options: Any) -> float:
    """Of a rod that starts across the flow, over what Jeffery says of a slender one."""
    body = bodies.placed(bodies.chain(nodes, 1.0), (0.0, 0.0), turned=np.pi / 2)
    angle, shear = turned(body, dtype, **options)
    return -angle / float(np.arctan(shear))


def check(name: Precision = "float32") -> Found:
    with precision(name) as dtype:
        ring, rod = ring_rate(dtype), rod_turn(dtype)
    return Found(
        [
            between(
                "passive ring: rate over half of the shear", ring, 0.95, 1.02, 1.0, "exact"
            ),
            close("passive rod: angle over that of a slender one", rod, 1.0, 0.05, JEFFERY),
        ]
    )
