"""Choice of the offspring to simulate: the largest expected gains of an archive.

Expected improvement: Jones, Schonlau and Welch, J. Global Optim. 13, 455 (1998), eq. 15, of the
elite in the cell that is predicted; as in surrogate-assisted illumination (Gaier, Asteroth and
Mouret, Evol. Comput. 26, 381 (2018)), whose acquisition is an upper confidence bound.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..insertion import Elites

Candidates = Float[Array, "candidate"]


class Predicted(eqx.Module):
    """What is predicted of candidates."""

    outputs: Float[Array, "candidate output"]
    """All outputs of the model; see `outputs`."""
    fitness: Candidates
    error: Candidates
    """Root mean square error of predicted fitness, the same for all candidates."""
    feasible: Candidates
    """Probability of being feasible."""
    cell: Int[Array, "candidate"]
    measures: Float[Array, "candidate measure"]
    """Predicted descriptors; other measures are 0."""


def heights(archive: Elites) -> Float[Array, "cell"]:
    """Return the fitness to exceed in each cell: its elite's, or in empty cells 0, or that of
    the least fit elite if it is negative."""
    empty = jnp.minimum(0.0, jnp.min(jnp.where(archive.occupied, archive.fitness, 0.0)))
    return jnp.where(archive.occupied, archive.fitness, empty)


def best(
    predicted: Predicted,
    height: Float[Array, "cell"],
    able: Bool[Array, "candidate"],
    count: Int[Array, ""] | int,
    most: int,
) -> tuple[Int[Array, "chosen"], Float[Array, "cell"]]:
    """Return the numbers of `count` candidates, largest expected gain first, and new heights.

    Each choice raises what the next one in its cell has to exceed. Only `able` ones are chosen.
    Numbers after the first `count` of `most` are 0.
    """

    def choose(place, state):
        found, height, able = state
        gain = expected_gain(predicted, height[predicted.cell])
        chosen = jnp.argmax(jnp.where(able, gain, -jnp.inf))
        cell = predicted.cell[chosen]
        likely, rise = predicted.feasible[chosen], predicted.fitness[chosen] - height[cell]
        height = height.at[cell].add(likely * jnp.maximum(rise, 0.0))
        found = found.at[place].set(chosen.astype(jnp.int32))
        return found, height, able.at[chosen].set(False)

    none = jnp.zeros(most, jnp.int32)
    found, height, _ = jax.lax.fori_loop(0, count, choose, (none, height, able))
    return found, height


def expected_gain(predicted: Predicted, height: Candidates) -> Candidates:
    """Return the probability of being feasible times the expected improvement on `height`."""
    error = jnp.maximum(predicted.error, 1e-9)
    rise = predicted.fitness - height
    z = rise / error
    density = jnp.exp(-0.5 * z * z) * 0.3989423
    return predicted.feasible * (rise * jax.scipy.special.ndtr(z) + error * density)
