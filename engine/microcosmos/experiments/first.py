"""First evaluations of elites that compete by means."""

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Float, Int


class FirstEvaluations(eqx.Module):
    """First evaluations of elites, in NumPy arrays with a row for each cell."""

    fitness: Float[np.ndarray, "cell"]
    measures: Float[np.ndarray, "cell measure"]
    count: Int[np.ndarray, "cell"]
    """Evaluations in the mean."""

    def of(self, cells: np.ndarray) -> dict[str, np.ndarray]:
        """Return the columns of some cells."""
        return vars(jax.tree.map(lambda x: x[cells], self))

    def replaced(self, cells: np.ndarray, rows: dict[str, np.ndarray]) -> "FirstEvaluations":
        """Return these with the rows of some cells replaced."""
        columns = {name: column.copy() for name, column in vars(self).items()}
        for name, column in columns.items():
            column[cells] = rows[name]
        return FirstEvaluations(**columns)


def no_first(cells: int, measures: int) -> FirstEvaluations:
    rows = np.zeros((cells, measures), np.float32)
    return FirstEvaluations(np.zeros(cells, np.float32), rows, np.zeros(cells, np.int32))
