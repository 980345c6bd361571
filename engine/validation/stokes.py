"""Flow without inertia in the same periodic box, solved independently by Fourier series.

The nodes act on the fluid through the same delta; viscosity does not matter, time neither:
a body goes where its sequence of shapes leads it.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import coupling


def displacement(positions: np.ndarray, size: tuple[int, int], samples: int) -> np.ndarray:
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
    """What each node alone spreads on the grid."""
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
