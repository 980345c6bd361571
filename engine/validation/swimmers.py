"""Checks of swimmers against Stokes flow, the scallop theorem and Newton's third law.

Fourier series solve Stokes flow in the same periodic box independently. The nodes act on it
through the same delta. Neither viscosity nor time matters: the sequence of shapes alone
determines the motion.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import coupling, filaments, fluid, world
from microcosmos.bodies import swimmers

from . import scenes, shapes
from .paths import JAX, Path, roll
from .rows import Result, at_most, close

PURCELL = "scallop theorem, Purcell 1977"
SIZE = (64, 64)


def second_cycle(
    swimmer: swimmers.Swimmer,
    viscosity: float,
    period: int,
    dtype: Any,
    path: Path = JAX,
    **options: Any,
) -> np.ndarray:
    """Return positions from the start of a swimmer's second cycle to its end."""
    box, start = scenes.immersed(swimmer.body, viscosity, dtype, **options)
    gait = scenes.stroke(swimmer, period, 2, dtype)
    return scenes.recorded(box, start, gait, path)[-period - 1 :]


def scallop_share(dtype: Any, path: Path = JAX, **options: Any) -> float:
    """Return displacement over path in the second cycle of a reciprocal swimmer at ν = 2."""
    cycle = second_cycle(swimmers.ray(), 2.0, 400, dtype, path, **options)
    moves = np.diff(cycle, axis=0)
    path = np.mean(np.sum(np.hypot(moves[..., 0], moves[..., 1]), 0))
    return float(np.hypot(*scenes.displacement(cycle)) / path)


@partial(jax.jit, static_argnames="path")
def _momenta(path, box, start, shapes):
    """Return the end, and the fluid's momentum after every step."""

    # Rollouts of one step each: the kernel records no momentum of the fluid.
    def advance(state, rest):
        one = jax.tree.map(lambda x: x[None], rest)
        state, _ = roll(path, box, state, one)
        return state, jnp.stack([jnp.sum(m) for m in fluid.momentum(state.populations)])

    return jax.lax.scan(advance, start, shapes)


def largest_impulse(
    box: world.World, start: world.State, shapes: filaments.Rest, path: Path = JAX
) -> float:
    """Return the largest impulse that bodies give the fluid; NaN if they do not stay finite."""
    end, impulses = _momenta(path, box, start, shapes)
    largest = np.sqrt(np.max(np.sum(np.asarray(impulses, float) ** 2, 1)))
    return float(largest) if np.all(np.isfinite(end.positions)) else float("nan")


def check_worm(
    cases: tuple[tuple[float, int, float], ...] = ((0.5, 2000, 0.05), (2.0, 2000, 0.08)),
    samples: int = 50,
    path: Path = JAX,
) -> Result:
    """Check the worm's second cycle; cases are viscosity, period and bar."""
    rows = []
    for viscosity, period, share in cases:
        cycle = second_cycle(swimmers.worm(), viscosity, period, "float32", path, size=SIZE)
        far, expected = scenes.displacement(cycle)[0], stokes_displacement(cycle, samples)[0]
        what = f"worm, ν {viscosity:g}, {period} steps a cycle: cells a cycle"
        rows.append(close(what, far, expected, share, "spectral Stokes flow, same shapes"))
    return Result(rows)


def check_spacing(
    spacings: tuple[float, ...] = (0.5, 1.5),
    viscosity: float = 0.5,
    period: int = 500,
    path: Path = JAX,
) -> Result:
    """Check the cells a cycle of the same worm at other node spacings."""

    def cells(spacing: float) -> float:
        swimmer = shapes.worm(spacing)
        cycle = second_cycle(swimmer, viscosity, period, "float32", path, size=SIZE)
        return float(np.hypot(*scenes.displacement(cycle)))

    expected = cells(1.0)
    return Result(
        [
            close(f"worm, spacing {spacing:g}: cells a cycle", cells(spacing), expected, 0.02,
                  "the same worm, spacing 1")
            for spacing in spacings
        ]
    )  # fmt: skip


def check_scallop(dtype: Any = "float32", path: Path = JAX) -> Result:
    what = "reciprocal swimmer, ν 2: displacement / path"
    return Result([at_most(what, scallop_share(dtype, path), 0.015, PURCELL)])


def check_impulse(
    names: tuple[str, ...] = tuple(swimmers.SWIMMERS),
    viscosities: tuple[float, ...] = (0.05, 2.0),
    period: int = 600,
    dtype: Any = "float32",
    limits: bool = True,
    path: Path = JAX,
) -> Result:
    """Check the impulse over two cycles, with or without the limits of evaluations."""
    rows = []
    for swimmer in (swimmers.SWIMMERS[one]() for one in names):
        for viscosity in viscosities:
            limit = scenes.limits(viscosity, dtype) if limits else world.Limits()
            box, start = scenes.immersed(swimmer.body, viscosity, dtype, limits=limit)
            gait = scenes.stroke(swimmer, period, 2, dtype)
            impulse = largest_impulse(box, start, gait, path)
            what = f"{swimmer.name}, ν {viscosity:g}: largest net impulse"
            rows.append(at_most(what, impulse, 1e-4, "Newton's third law"))
    return Result(rows)


def stokes_displacement(positions: np.ndarray, samples: int) -> np.ndarray:
    """Return the displacement of a body in Stokes flow by the same sequence of shapes.

    At `samples` times, forces without net force and torque make the fluid follow the nodes
    up to a rigid motion.
    """
    every = (len(positions) - 1) // samples
    with jax.enable_x64(True):
        velocities = [
            _free_velocity(positions[t], positions[t + 1] - positions[t])
            for t in range(0, len(positions) - 1, every)
        ]
    return every * np.sum(velocities, 0)


def _free_velocity(x: np.ndarray, change: np.ndarray) -> np.ndarray:
    # Unknowns are the forces at nodes and a rigid motion; the last three rows say that the
    # forces have neither sum nor torque.
    nodes, arm = len(x), x - x.mean(0)
    one, none = np.ones(nodes), np.zeros(nodes)
    rigid = np.block([[one, none], [none, one], [-arm[:, 1], arm[:, 0]]]).T
    system = np.block([[mobility(x), -rigid], [rigid.T, np.zeros((3, 3))]])
    known = np.concatenate([change[:, 0], change[:, 1], np.zeros(3)])
    return change.mean(0) + np.linalg.solve(system, known)[-3:-1]


@jax.jit
def _deltas(positions):
    """Return the density that each node alone spreads on the grid."""
    at = coupling.windows(positions, SIZE, world.Form().kernel)
    alone = jnp.eye(len(positions))[:, :, None]
    return jax.vmap(lambda one: coupling.spread(one, at, SIZE)[0])(alone)


def mobility(positions: np.ndarray) -> np.ndarray:
    """Return the matrix from forces to velocities at nodes, x before y, at viscosity 1."""
    nodes = len(positions)
    deltas = np.asarray(_deltas(jnp.asarray(positions)))
    kx, ky = (2 * np.pi * np.fft.fftfreq(n) for n in SIZE)
    k = np.stack(np.meshgrid(kx, ky, indexing="ij"))
    square = np.sum(k**2, 0)
    square[0, 0] = np.inf  # Forces without a sum leave the mean flow at rest.
    waves = np.fft.fft2(deltas)

    def block(i, j):
        tensor = ((i == j) - k[i] * k[j] / square) / square
        flows = np.fft.ifft2(waves * tensor).real
        return deltas.reshape(nodes, -1) @ flows.reshape(nodes, -1).T

    return np.block([[block(i, j) for j in range(2)] for i in range(2)])
