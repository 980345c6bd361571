"""Swimmers against Stokes flow, the scallop theorem and Newton's third law.

Stokes flow in the same periodic box is solved independently by Fourier series. The nodes act on
it through the same delta; neither viscosity nor time matters: a body goes where its sequence
of shapes leads it.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import coupling, filaments, fluid, world
from microcosmos.bodies import swimmers

from . import scenes
from .rows import Found, Precision, at_most, close, precision

PURCELL = "scallop theorem, Purcell 1977"


def worm_against_stokes(
    viscosity: float, period: int, dtype: Any, *, samples: int = 50
) -> tuple[float, float]:
    """Cells in the second cycle of a worm, and in Stokes flow by the same shapes."""
    swimmer, size = swimmers.worm(), (64, 64)
    box, start = scenes.immersed(swimmer.body, viscosity, dtype, size=size)
    gait = scenes.stroke(swimmer, period, 2, dtype)
    cycle = scenes.recorded(box, start, gait)[-period - 1 :]
    expected = stokes_displacement(cycle, size, samples)
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


def stokes_displacement(
    positions: np.ndarray, size: tuple[int, int], samples: int
) -> np.ndarray:
    """How far the body would go by the shapes that it went through.

    At some of the times, the forces are found that make the fluid follow the nodes but for
    a rigid motion, without net force and torque.
    """
    every = (len(positions) - 1) // samples
    with jax.enable_x64(True):
        velocities = [
            _free_velocity(positions[t], positions[t + 1] - positions[t], size)
            for t in range(0, len(positions) - 1, every)
        ]
    return every * np.sum(velocities, 0)


def _free_velocity(x: np.ndarray, change: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    nodes, arm = len(x), x - x.mean(0)
    one, none = np.ones(nodes), np.zeros(nodes)
    rigid = np.block([[one, none], [none, one], [-arm[:, 1], arm[:, 0]]]).T
    system = np.block([[mobility(x, size), -rigid], [rigid.T, np.zeros((3, 3))]])
    known = np.concatenate([change[:, 0], change[:, 1], np.zeros(3)])
    return change.mean(0) + np.linalg.solve(system, known)[-3:-1]


@partial(jax.jit, static_argnames="size")
def _deltas(positions, size: tuple[int, int]):
    """The density that each node alone spreads on the grid."""
    at = coupling.windows(positions, size)
    alone = jnp.eye(len(positions))[:, :, None]
    return jax.vmap(lambda one: coupling.spread(one, at, size)[0])(alone)


def mobility(positions: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Velocities at nodes by forces there, x before y, for a viscosity of 1."""
    nodes = len(positions)
    deltas = np.asarray(_deltas(jnp.asarray(positions), size))
    kx, ky = (2 * np.pi * np.fft.fftfreq(n) for n in size)
    k = np.stack(np.meshgrid(kx, ky, indexing="ij"))
    square = np.sum(k**2, 0)
    square[0, 0] = np.inf
    waves = np.fft.fft2(deltas)

    def block(i, j):
        tensor = ((i == j) - k[i] * k[j] / square) / square
        flows = np.fft.ifft2(waves * tensor).real
        return deltas.reshape(nodes, -1) @ flows.reshape(nodes, -1).T

    return np.block([[block(i, j) for j in range(2)] for i in range(2)])
