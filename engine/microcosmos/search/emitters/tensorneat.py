"""TensorNEAT's own population in place of ours, where that package is installed."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ...neat import Counters
from ..insertion import Elites
from ..tensorneat import Backend
from .elites import orphans
from .emitter import Children, Keys, Outcome

Arrays = dict[str, np.ndarray] | dict[str, Array]


@dataclass(frozen=True)
class TensorNeat:
    """Its ask-tell loop under our run's life: the state is kept as arrays.

    It computes on the host between our programs, and tells nothing of parents.
    """

    slots: int
    backend: Backend
    seed: int

    def init(self, *, key: PRNGKeyArray) -> Arrays:
        """The first population."""
        return self.backend.to_arrays(self.backend.setup(self.seed))

    def emit(
        self,
        state: Arrays,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, Arrays, Counters]:
        """Its population as our networks."""
        networks, _ = self.backend.population(self.backend.from_arrays(state))
        return orphans(networks, self.slots, "tensorneat"), state, counters

    def tell(self, state: Arrays, outcome: Outcome) -> Arrays:
        """Its next population; what diverged, or lacks an output, counts worst."""
        before = self.backend.from_arrays(state)
        sound = np.asarray(outcome.sound) & self._whole(before)
        fitness: Float[np.ndarray, "slot"] = np.where(sound, outcome.fitness, -np.inf)
        return self.backend.to_arrays(self.backend.tell(before, fitness))

    def _whole(self, state) -> Bool[np.ndarray, "slot"]:
        """Which networks compute every output."""
        return self.backend.population(state)[1]
