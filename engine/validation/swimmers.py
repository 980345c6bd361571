"""Swimmers against Stokes flow, the scallop theorem and Newton's third law."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import filaments, fluid, world
from microcosmos.bodies import swimmers

from . import scenes, stokes
from .precision import Precision, precision
from .rows import Found, at_most, close

PURCELL = "scallop theorem, Purcell 1977"


def worm_against_stokes(
    viscosity: float, period: int, dtype: Any, *, samples: int = 50
) -> tuple[float, float]:
    """Cells in the second cycle of a worm, and in Stokes flow by the same shapes."""
    swimmer, size = swimmers.worm(), (64, 64)
    box, start = scenes.immersed(swimmer.body, viscosity, dtype, size=size)
    gait = scenes.stroke(swimmer, period, 2, dtype)
    cycle = scenes.recorded(box, start, gait)[-period - 1 :]
    expected = stokes.displacement(cycle, size, samples)
    return float(scenes.displacement(cycle)[0]), float(expected[0])


def scallop_share(dtype: Any, *, period: int = 400, **options: Any) -> float:
    """Displacement over path in the second cycle of a reciprocal swimmer at ν = 2."""
    swimmer = swimmers.ray()
    box, start = scenes.immersed(swimmer.body, 2.0, dtype, **options)
    gait = scenes.stroke(swimmer, period, 2, dtype)
    cycle = scenes.recorded(box, start, gait)[-period - 1 :]
    return float(np.hypot(*scenes.displacement(cycle)) / scenes.mean_path(cycle))


@jax.jit
def _momenta(box, start, shapes):
    def momentum(state, _):
        return jnp.stack([jnp.sum(m) for m in fluid.momentum(state.populations)])

    return world.rollout(box, start, shapes, momentum)


def largest_impulse(box: world.World, start: world.State, shapes: filaments.Rest) -> float:
    """The largest sum of forces, accumulated over time, that bodies gave the fluid.

    Not a number if the bodies did not stay finite.
    """
    end, given = _momenta(box, start, shapes)
    largest = np.sqrt(np.max(np.sum(np.asarray(given, float) ** 2, 1)))
    return float(largest) if np.all(np.isfinite(end.positions)) else float("nan")


def check_worm(
    cases: tuple[tuple[float, int, float], ...] = ((0.5, 2000, 0.05), (2.0, 2000, 0.08)),
    samples: int = 50,
    name: Precision = "float32",
) -> Found:
    """Each case is a viscosity, a period in steps and a bar."""
    rows = []
    for viscosity, period, share in cases:
        with precision(name) as dtype:
            here, expected = worm_against_stokes(viscosity, period, dtype, samples=samples)
        what = f"worm, ν {viscosity:g}, {period} steps a cycle: cells a cycle"
        rows.append(close(what, here, expected, share, "spectral Stokes flow, same shapes"))
    return Found(rows)


def check_scallop(name: Precision = "float32") -> Found:
    with precision(name) as dtype:
        share = scallop_share(dtype)
    return Found(
        [at_most("reciprocal swimmer, ν 2: displacement / path", share, 0.015, PURCELL)]
    )


def check_impulse(
    names: tuple[str, ...] = tuple(swimmers.SWIMMERS),
    viscosities: tuple[float, ...] = (0.05, 2.0),
    period: int = 600,
    name: Precision = "float32",
    limits: bool = True,
) -> Found:
    """Over two cycles, with or without the limits that creatures live with."""
    rows = []
    for swimmer in (swimmers.SWIMMERS[one]() for one in names):
        for viscosity in viscosities:
            with precision(name) as dtype:
                limit = scenes.limits(viscosity, dtype) if limits else world.Limits()
                box, start = scenes.immersed(swimmer.body, viscosity, dtype, limits=limit)
                impulse = largest_impulse(box, start, scenes.stroke(swimmer, period, 2, dtype))
            what = f"{swimmer.name}, ν {viscosity:g}: largest net impulse"
            rows.append(at_most(what, impulse, 1e-4, "Newton's third law"))
    return Found(rows)
