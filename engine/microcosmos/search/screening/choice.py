"""Choice of the offspring to simulate, from what a model predicts of them.

The choice has the largest expected improvement (Jones, Schonlau and Welch, J. Global Optim. 13,
455 (1998), eq. 15) of the elite in the predicted cell; as in surrogate-assisted illumination
(Gaier, Asteroth and Mouret, Evol. Comput. 26, 381 (2018)), whose acquisition is an upper
confidence bound.
"""

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ... import exact, units
from ..cells import Axis, Cells
from ..evaluation import Evaluation
from ..insertion import Elites
from ..measures import MEASURES
from .description import Described
from .model import Model, Regression

Candidates = Float[Array, "candidate"]


class Predicted(eqx.Module):
    """Predictions of candidates."""

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
        chosen_rows, height, able = state
        gain = expected_gain(predicted, height[predicted.cell])
        chosen = jnp.argmax(jnp.where(able, gain, -jnp.inf))
        cell = predicted.cell[chosen]
        likely, rise = predicted.feasible[chosen], predicted.fitness[chosen] - height[cell]
        height = height.at[cell].add(likely * jnp.maximum(rise, 0.0))
        chosen_rows = chosen_rows.at[place].set(chosen.astype(jnp.int32))
        return chosen_rows, height, able.at[chosen].set(False)

    none = jnp.zeros(most, jnp.int32)
    chosen_rows, height, _ = jax.lax.fori_loop(0, count, choose, (none, height, able))
    return chosen_rows, height


def expected_gain(predicted: Predicted, height: Candidates) -> Candidates:
    """Return the probability of being feasible times the expected improvement on `height`."""
    error = jnp.maximum(predicted.error, 1e-9)
    rise = predicted.fitness - height
    z = rise / error
    density = jnp.exp(-0.5 * z * z) * 0.3989423
    return predicted.feasible * (rise * jax.scipy.special.ndtr(z) + error * density)


SLOWEST = 1e-6
"""Smallest Mach number whose logarithm is learned."""


@dataclass(frozen=True)
class Outputs:
    """The outputs of a model: fitness, the place on each axis from 0 to 1, the logarithm of the
    largest Mach number, and 1 for a feasible creature or 0."""

    axes: tuple[Axis, ...]
    measures: int
    """Number of measures of a creature."""
    bounded: bool
    """True if the search refuses creatures above the largest Mach number."""

    @property
    def count(self) -> int:
        return len(self.axes) + 3

    def of(self, evaluation: Evaluation) -> Float[np.ndarray, "row output"]:
        """Return the outputs of evaluations in NumPy."""
        measures = np.asarray(evaluation.measures)
        mach = np.maximum(measures[:, MEASURES.index("mach")], SLOWEST)
        columns = [
            np.asarray(evaluation.fitness),
            *(
                np.asarray(axis.place(jnp.asarray(measures[:, axis.measure])))
                for axis in self.axes
            ),
            exact.logarithm(np.where(np.isfinite(mach), mach, 1.0)),
            evaluation.status == 0,
        ]
        return np.stack([np.asarray(column, float) for column in columns], 1)

    def predict(
        self, described: Described, regression: Regression, model: Model, cells: Cells
    ) -> Predicted:
        """Return the predictions of a model for creatures."""
        outputs = regression.predict(described.inputs, model)
        errors = jnp.sqrt(jnp.asarray(model.errors, jnp.float32))
        axes = len(self.axes)
        measures = jnp.zeros((len(outputs), self.measures), outputs.dtype)
        for number, axis in enumerate(self.axes):
            known, guess = described.known[:, number], axis.value(outputs[:, 1 + number])
            value = jnp.where(jnp.isnan(known), guess, known)
            measures = measures.at[:, axis.measure].set(value)
        # Regression on 0 and 1 may leave that range; no candidate is ruled out by it
        # altogether.
        feasible = jnp.clip(outputs[:, -1], 0.02, 1.0)
        if self.bounded:
            room = np.float32(np.log(units.MAX_MACH)) - outputs[:, 1 + axes]
            feasible = feasible * jax.scipy.special.ndtr(room / (errors[1 + axes] + 1e-6))
        return Predicted(
            outputs=outputs,
            fitness=outputs[:, 0],
            error=jnp.broadcast_to(errors[0], outputs[:, 0].shape),
            feasible=feasible,
            cell=cells.of(measures),
            measures=measures,
        )
