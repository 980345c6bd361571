"""TensorNEAT's population as an emitter, if that package is installed."""

from dataclasses import dataclass, replace

import equinox as eqx
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ..insertion import Elites
from ..tensorneat import Backend, State
from .elites import parentless
from .emitter import Children, Keys, Outcome


class TensorNeatState(eqx.Module):
    """TensorNEAT's state; its population is the one emitted last."""

    arrays: dict[str, np.ndarray] | dict[str, Array]
    fitness: Float[np.ndarray, "slot"] | Float[Array, "slot"]
    """−∞ until measured."""
    age: Int[np.ndarray, ""] | Int[Array, ""]
    """Generations emitted so far."""

    def sizes(self) -> dict[int, int]:
        of = np.asarray(self.arrays["species.idx2species"]).astype(int)
        numbers, members = np.unique(of, return_counts=True)
        return dict(zip(numbers.tolist(), members.tolist(), strict=True))


@dataclass(frozen=True)
class TensorNeat:
    """TensorNEAT's ask-tell loop, on the host between our programs, its state kept as arrays.

    It numbers genes itself and does not report parents. Children that diverge or lack an output
    have the worst fitness.
    """

    slots: int
    backend: Backend
    seed: int

    def init(self, *, key: PRNGKeyArray) -> TensorNeatState:
        return self._unmeasured(self.backend.setup(self.seed), 0)

    def emit(
        self, state: TensorNeatState, archive: Elites, *, keys: Keys
    ) -> tuple[Children, TensorNeatState, None]:
        """Return the first population, then the one that it makes of the one before."""
        theirs = self.backend.from_arrays(state.arrays)
        if state.age > 0:
            theirs = self.backend.tell(theirs, np.asarray(state.fitness))
        networks, _ = self.backend.population(theirs)
        children = parentless(networks, self.slots, "tensorneat")
        return children, self._unmeasured(theirs, int(state.age) + 1), None

    def tell(self, state: TensorNeatState, outcome: Outcome) -> TensorNeatState:
        _, whole = self.backend.population(self.backend.from_arrays(state.arrays))
        feasible = np.asarray(outcome.feasible) & whole
        fitness = np.where(feasible, outcome.fitness, -np.inf).astype(np.float32)
        return replace(state, fitness=fitness)

    def _unmeasured(self, theirs: State, age: int) -> TensorNeatState:
        arrays, unmeasured = self.backend.to_arrays(theirs), np.full(self.slots, -np.inf, "f4")
        return TensorNeatState(arrays, unmeasured, np.array(age, np.int32))
