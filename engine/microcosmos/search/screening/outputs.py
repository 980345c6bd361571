"""What a model predicts of a creature: fitness, descriptors, and whether it is feasible."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ... import exact, units
from ..cells import Axis, Cells
from ..evaluation import Evaluation
from ..measures import MEASURES
from .choice import Predicted
from .description import Described
from .model import Model, Regression

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
    """Whether the search refuses creatures above the largest Mach number."""

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
        found = regression.predict(described.inputs, model)
        errors = jnp.sqrt(jnp.asarray(model.errors, jnp.float32))
        axes = len(self.axes)
        measures = jnp.zeros((len(found), self.measures), found.dtype)
        for number, axis in enumerate(self.axes):
            known, guess = described.known[:, number], axis.value(found[:, 1 + number])
            value = jnp.where(jnp.isnan(known), guess, known)
            measures = measures.at[:, axis.measure].set(value)
        feasible = jnp.clip(found[:, -1], 0.02, 1.0)
        if self.bounded:
            room = np.float32(np.log(units.MAX_MACH)) - found[:, 1 + axes]
            feasible = feasible * jax.scipy.special.ndtr(room / (errors[1 + axes] + 1e-6))
        return Predicted(
            outputs=found,
            fitness=found[:, 0],
            error=jnp.broadcast_to(errors[0], found[:, 0].shape),
            feasible=feasible,
            cell=cells.of(measures),
            measures=measures,
        )
