"""Checks of bodies in a fluid: passive ones in a shear flow, repulsion, random controllers.

A passive circle turns with half of the shear. The tangent of a slender rod's angle grows with
the shear: G. B. Jeffery, Proc. R. Soc. A 102, 161 (1922).
"""

from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fluid, world

from . import scenes
from .paths import JAX, Path, roll
from .rows import Result, Row, at_least, at_most, close

JEFFERY = "Jeffery 1922"
SIZE = (64, 64)
SOUND = 3**-0.5
"""Speed of sound, in cells a step."""
VISCOSITIES = (0.001, 0.003, 0.01, 0.05, 0.3, 2.0)


def rotation(positions: np.ndarray) -> float:
    """Return the turn of a body as a whole, anticlockwise, in radians."""
    arms = positions - positions.mean(1, keepdims=True)
    a, b = arms[:-1], arms[1:]
    sine = np.sum(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], 1)
    return float(np.sum(np.arctan2(sine, np.sum(a * b, (1, 2)))))


def turn_and_shear(
    body: bodies.Body,
    dtype: Any,
    *,
    steps: int = 500,
    viscosity: float = 0.05,
    speed: float = 0.02,
    path: Path = JAX,
    **options: Any,
) -> tuple[float, float]:
    """Return a body's turn in a decaying sine flow, and the shear integrated over time.

    The body starts where the flow is still and its shear strongest.
    """
    box, start = scenes.immersed(body, viscosity, dtype, size=SIZE, **options)
    k = 2 * np.pi / SIZE[1]
    wave = np.tile(speed * np.sin(k * (np.arange(SIZE[1]) - SIZE[1] / 2)), (SIZE[0], 1))
    u = jnp.asarray(np.stack([wave, np.zeros(SIZE)]), dtype)
    start = replace(start, populations=fluid.equilibrium(jnp.ones(SIZE, dtype), u))
    positions = scenes.recorded(box, start, scenes.held(body, steps, dtype), path)
    # The flow decays while the body turns, so the shear is summed step by step.
    decay = np.exp(-viscosity * k**2 * np.arange(steps))
    return rotation(positions), float(speed * k * np.sum(decay))


def check_passive(dtype: Any = "float32", path: Path = JAX) -> Result:
    """Check the turn of a ring, and of a rod that starts across the flow."""
    ring, ring_shear = turn_and_shear(bodies.ring(28, 1.0), dtype, path=path)
    across = bodies.placed(bodies.chain(12, 1.0), (0.0, 0.0), turned=np.pi / 2)
    rod, rod_shear = turn_and_shear(across, dtype, path=path)
    rate, angle = -ring / (0.5 * ring_shear), -rod / np.arctan(rod_shear)
    what, bar = "passive ring: rate over half of the shear", "0.95 to 1.02"
    rows = [
        Row(what, rate, 0.95, 1.02, bar, 1.0, "exact"),
        close("passive rod: angle over that of a slender one", angle, 1.0, 0.05, JEFFERY),
    ]
    return Result(rows)


def check_repulsion(steps: int = 300, dtype: Any = "float32", path: Path = JAX) -> Result:
    """Check the final gap between two parallel chains, and the largest net force on either."""
    pair, limits = scenes.parallel_chains(20, 1.0), scenes.limits(0.3, dtype)
    steric = scenes.steric(4.0, dtype)
    box, start = scenes.immersed(pair, 0.3, dtype, steric=steric, limits=limits)
    rest = scenes.held(pair, steps, dtype)
    end, forces = roll(path, box, start, rest, scenes.force)
    y = scenes.unwrapped(box, end.positions, end.boxes)[:, 1]
    gap, force = y[20:].mean() - y[:20].mean(), np.max(np.abs(np.asarray(forces, float)))
    what = f"two bodies a cell apart, after {steps} steps"
    rows = [
        at_least(f"{what}: gap (cells)", gap, 3.0, 4.0, "reach of the repulsion"),
        at_most(f"{what}: sum of forces of either", force, 1e-6, "Newton's third law"),
    ]
    return Result(rows)


@partial(jax.jit, static_argnames="path")
def _survive(path, box, start, rests):
    """Return a flag for each motion: all numbers stay finite and all speeds subsonic."""

    def survives(rest):
        end, _ = roll(path, box, start, rest)
        speed = jnp.sqrt(jnp.max(jnp.sum(world.flow(box, end) ** 2, 0)))
        finite = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(end)]
        return jnp.all(jnp.stack(finite)) & (speed < SOUND)

    return jax.lax.map(survives, rests)


def check_stability(
    viscosities: tuple[float, ...] = VISCOSITIES,
    seeds: int = 10,
    steps: int = 3000,
    path: Path = JAX,
) -> Result:
    rows, body, dtype = [], bodies.chain(32, 1.0), "float32"
    for viscosity in viscosities:
        limits = scenes.limits(viscosity, dtype)
        box, start = scenes.immersed(body, viscosity, dtype, limits=limits)
        rests = [scenes.erratic(body, steps, dtype, seed) for seed in range(seeds)]
        together = jax.tree.map(lambda *x: jnp.stack(x), *rests)
        count = np.sum(_survive(path, box, start, together))
        what = f"random controllers finite over {steps:,} steps, ν {viscosity:g}"
        rows.append(at_least(what, count, seeds, seeds, f"all {seeds} seeds"))
    return Result(rows)
