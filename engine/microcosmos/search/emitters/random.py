"""Random search: a baseline that learns nothing."""

from dataclasses import dataclass

from jaxtyping import Array, Int, PRNGKeyArray

from ...neat import Counters
from ..insertion import Elites
from .elites import Newcomer, newcomers
from .emitter import Children, Keys, Outcome


@dataclass(frozen=True)
class Random:
    """New random genotypes in every generation."""

    slots: int
    newcomer: Newcomer

    def init(self, *, key: PRNGKeyArray) -> None:
        """Nothing is kept."""

    def emit(
        self,
        state: None,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, None, Counters]:
        """A newcomer in each slot."""
        return newcomers(self.newcomer, keys), None, counters

    def tell(self, state: None, outcome: Outcome) -> None:
        """Nothing is learnt."""
