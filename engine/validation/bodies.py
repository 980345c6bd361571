"""Bodies in a fluid: passive ones in a shear flow, repulsion, random controllers.

A passive circle turns with half of the shear; a rod as G. B. Jeffery, Proc. R. Soc. A 102, 161
(1922), says of a slender one: tan of its angle grows with the shear.
"""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fields, fluid, world

from . import scenes
from .rows import Found, Precision, at_least, at_most, between, close, precision

JEFFERY = "Jeffery 1922"
SIZE = (64, 64)
SOUND = 3**-0.5
"""Speed of sound, in cells a step."""
VISCOSITIES = (0.001, 0.003, 0.01, 0.05, 0.3, 2.0)


def rotation(positions: np.ndarray) -> float:
    """The turn of a body as a whole, anticlockwise, in radians."""
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
    """The turn of a body in a decaying sine flow, and the shear integrated over time.

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
    """The turn of a ring over half of the shear."""
    angle, shear = turned(bodies.ring(nodes, 1.0), dtype, **options)
    return -angle / (0.5 * shear)


def rod_turn(dtype: Any, nodes: int = 12, **options: Any) -> float:
    """The turn of a rod that starts across the flow, over Jeffery's for a slender one."""
    body = bodies.placed(bodies.chain(nodes, 1.0), (0.0, 0.0), turned=np.pi / 2)
    angle, shear = turned(body, dtype, **options)
    return -angle / float(np.arctan(shear))


def check_passive(name: Precision = "float32") -> Found:
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


def check_repulsion(steps: int = 300, name: Precision = "float32") -> Found:
    with precision(name) as dtype:
        gap, force = apart(dtype, steps=steps)
    what = f"two bodies a cell apart, after {steps} steps"
    return Found(
        [
            at_least(f"{what}: gap (cells)", gap, 3.0, 4.0, "reach of the repulsion"),
            at_most(f"{what}: sum of forces of either", force, 1e-6, "Newton's third law"),
        ]
    )


@jax.jit
def _lives(box, start, rests):
    def lives(rest):
        end, _ = world.rollout(box, start, rest)
        speed = jnp.sqrt(jnp.max(jnp.sum(world.flow(box, end) ** 2, 0)))
        whole = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(end)]
        return jnp.all(jnp.stack(whole)) & (speed < SOUND)

    return jax.lax.map(lives, rests)


def survivors(viscosity: float, seeds: int, steps: int, dtype: Any) -> int:
    """The number of random controllers under which all stays finite and subsonic."""
    body = bodies.chain(32, 1.0)
    limits = scenes.limits(viscosity, dtype)
    box, start = scenes.immersed(body, viscosity, dtype, limits=limits)
    rests = [scenes.erratic(body, steps, dtype, seed) for seed in range(seeds)]
    return int(np.sum(_lives(box, start, jax.tree.map(lambda *x: jnp.stack(x), *rests))))


def check_stability(
    viscosities: tuple[float, ...] = VISCOSITIES, seeds: int = 10, steps: int = 3000
) -> Found:
    rows = []
    for viscosity in viscosities:
        with precision("float32") as dtype:
            count = survivors(viscosity, seeds, steps, dtype)
        what = f"random controllers finite over {steps:,} steps, ν {viscosity:g}"
        rows.append(at_least(what, count, seeds, seeds, f"all {seeds} seeds"))
    return Found(rows)
