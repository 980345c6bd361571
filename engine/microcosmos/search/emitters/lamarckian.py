"""NEAT whose children take gradient steps before evaluation; offspring inherit the result.

Topology by mutation, weights by gradient steps: each child climbs a random combination of
fitness and descriptors, as the emitters of OMG-MEGA do (Fontaine and Nikolaidis, NeurIPS 2021,
algorithm 1), so that children of one elite spread over the archive.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray

from ...genomes import Genotype
from ...neat import Novelty
from ..gradients import Slopes, genes_of, unit, with_genes
from ..insertion import Elites
from .emitter import OPERATORS, Children, Keys, Outcome
from .neat import Neat


class Directions(eqx.Module):
    """The direction of each child of the present generation."""

    weights: Float[Array, "slot output"]
    """Weights on the unit slopes of fitness and of every descriptor."""


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
        return self.neat.slots

    def init(self, *, key: PRNGKeyArray) -> Directions:
        return Directions(jnp.zeros((self.slots, self.outputs), jnp.float32))

    def emit(
        self, state: Directions, archive: Elites, *, keys: Keys
    ) -> tuple[Children, Directions, Novelty]:
        children, _, novelty = self.neat.emit(None, archive, keys=keys)
        shape = (self.outputs,)
        drawn = jax.vmap(lambda key: jax.random.normal(jax.random.fold_in(key, 2), shape))(keys)
        weights = (self.diversity * drawn).at[:, 0].set(1.0)
        mutated = children.operator == OPERATORS.index("neat")
        operator = jnp.where(mutated, OPERATORS.index("lamarckian"), children.operator)
        return replace(children, operator=operator), Directions(weights), novelty

    def to_differentiate(self, state: Directions, children: Children) -> Genotype:
        return children.genotypes

    def learn(
        self, state: Directions, children: Children, slopes: Slopes
    ) -> tuple[Children, Directions]:
        """Move each child a step; those without finite slopes stay."""
        way = unit(jnp.sum(state.weights[:, :, None] * unit(slopes.rows), 1))
        way = jnp.where(slopes.finite[:, None], way, 0.0)
        genes = jax.vmap(genes_of)(children.genotypes) + self.step * way
        learnt = jax.vmap(with_genes)(children.genotypes, genes)
        return replace(children, genotypes=learnt), state

    def tell(self, state: Directions, outcome: Outcome) -> Directions:
        return state
