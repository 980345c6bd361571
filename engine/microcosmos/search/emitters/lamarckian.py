"""NEAT whose children learn before they live, and pass on what they have learnt.

Topology by mutation, weights by gradient steps: each child climbs a random combination of
fitness and descriptors, as the emitters of OMG-MEGA do (Fontaine and Nikolaidis, NeurIPS 2021,
algorithm 1), so that children of one elite spread over the archive.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ...genomes import CPPN, Genotype
from ...neat import Counters
from ..gradients import genes_of, with_genes
from ..insertion import Elites
from .emitter import OPERATORS, Children, Keys, Outcome
from .learner import Slopes, unit
from .neat import Neat


class Wishes(eqx.Module):
    """Where each child of the present generation wants to go."""

    weights: Float[Array, "slot output"]
    """On the unit slopes of fitness and of every descriptor."""


@dataclass(frozen=True)
class Lamarckian:
    """NEAT's variation, then `lessons` steps along slopes."""

    neat: Neat
    outputs: int
    """Fitness and descriptors."""
    lessons: int = 2
    step: float = 0.3
    """Length of a step in the space of weights and biases."""
    diversity: float = 1.0
    """Standard deviation of a descriptor's weight beside fitness, which has 1."""

    @property
    def slots(self) -> int:
        """Children a generation."""
        return self.neat.slots

    def init(self, *, key: PRNGKeyArray) -> Wishes:
        """No child yet."""
        return Wishes(jnp.zeros((self.slots, self.outputs), jnp.float32))

    def emit(
        self,
        state: Wishes,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, Wishes, Counters]:
        """As NEAT varies elites; newcomers where there are none."""
        children, _, counters = self.neat.emit(None, archive, counters, generation, keys=keys)
        shape = (self.outputs,)
        drawn = jax.vmap(lambda key: jax.random.normal(jax.random.fold_in(key, 2), shape))(keys)
        weights = (self.diversity * drawn).at[:, 0].set(1.0)
        mutated = children.operator == OPERATORS.index("neat")
        operator = jnp.where(mutated, OPERATORS.index("lamarckian"), children.operator)
        return replace(children, operator=operator), Wishes(weights), counters

    def asks(self, state: Wishes, children: Children) -> Genotype:
        """Of every child."""
        return children.genotypes

    def learn(
        self, state: Wishes, children: Children, slopes: Slopes
    ) -> tuple[Children, Wishes]:
        """Each child one step further; those without sound slopes stay as they are."""
        networks = children.genotypes
        assert isinstance(networks, CPPN)
        way = unit(jnp.sum(state.weights[:, :, None] * unit(slopes.rows), 1))
        way = jnp.where(slopes.sound[:, None], way, 0.0)
        genes = jax.vmap(genes_of)(networks) + self.step * way
        return replace(children, genotypes=jax.vmap(with_genes)(networks, genes)), state

    def tell(self, state: Wishes, outcome: Outcome) -> Wishes:
        """Nothing is learnt but what the archive holds."""
        return state
