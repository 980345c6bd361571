"""TensorNEAT's own population in place of ours, where that package is installed."""

from dataclasses import dataclass, replace

import equinox as eqx
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ...neat import Counters
from ..insertion import Elites
from ..tensorneat import Backend, State
from .elites import orphans
from .emitter import Children, Keys, Outcome


class Foreign(eqx.Module):
    """TensorNEAT's state, whose population is the one that was emitted last."""

    arrays: dict[str, np.ndarray] | dict[str, Array]
    fitness: Float[np.ndarray, "slot"] | Float[Array, "slot"]
    """−∞ until it is told."""
    age: Int[np.ndarray, ""] | Int[Array, ""]
    """Generations that were emitted."""

    def sizes(self) -> dict[int, int]:
        """Members of each species, by its number."""
        of = np.asarray(self.arrays["species.idx2species"]).astype(int)
        numbers, members = np.unique(of, return_counts=True)
        return dict(zip(numbers.tolist(), members.tolist(), strict=True))


@dataclass(frozen=True)
class TensorNeat:
    """Its ask-tell loop under our run's life: the state is kept as arrays.

    It computes on the host between our programs, and tells nothing of parents.
    """

    slots: int
    backend: Backend
    seed: int

    def init(self, *, key: PRNGKeyArray) -> Foreign:
        """The first population."""
        return self._untold(self.backend.setup(self.seed), 0)

    def emit(
        self,
        state: Foreign,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, Foreign, Counters]:
        """The first population, then the one that it makes of the one before."""
        theirs = self.backend.from_arrays(state.arrays)
        if state.age > 0:
            theirs = self.backend.tell(theirs, np.asarray(state.fitness))
        networks, _ = self.backend.population(theirs)
        children = orphans(networks, self.slots, "tensorneat")
        return children, self._untold(theirs, int(state.age) + 1), counters

    def tell(self, state: Foreign, outcome: Outcome) -> Foreign:
        """What diverged, or lacks an output, counts worst."""
        _, whole = self.backend.population(self.backend.from_arrays(state.arrays))
        sound = np.asarray(outcome.sound) & whole
        fitness = np.where(sound, outcome.fitness, -np.inf).astype(np.float32)
        return replace(state, fitness=fitness)

    def _untold(self, theirs: State, age: int) -> Foreign:
        """What is kept of a state whose population is not measured yet."""
        nobody = np.full(self.slots, -np.inf, np.float32)
        return Foreign(self.backend.to_arrays(theirs), nobody, np.array(age, np.int32))
