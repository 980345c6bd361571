"""NEAT's mutations, and its crossover, as variation inside an archive."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, PRNGKeyArray

from ... import neat
from ...genomes import Graph
from ..insertion import Elites
from .elites import Newcomer, children, newcomers, or_newcomers
from .emitter import NO_PARENT, OPERATORS, Children, Keys, Stateless
from .selection import Select, draw


@dataclass(frozen=True)
class Neat(Stateless):
    """Mutated elites, some of them crossed with another one first."""

    slots: int
    newcomer: Newcomer
    rates: neat.Rates
    inputs: int
    crossover: float = 0.0
    """Probability that a child has two parents."""
    select: Select = "uniform"

    def emit(
        self, state: None, archive: Elites, *, keys: Keys
    ) -> tuple[Children, None, neat.Novelty]:
        def child(key):
            select_key, mutate_key = jax.random.split(key)
            cell = draw(archive, self.select, key=select_key)
            parent, other = _network(archive, cell), jnp.asarray(NO_PARENT)
            if self.crossover:
                parent, other = self._crossed(archive, cell, key=key)
            network, novelty = neat.mutate(parent, self.rates, self.inputs, key=mutate_key)
            return network, novelty, cell, other

        networks, novelty, first, second = jax.vmap(child)(keys)
        varied = children(networks, [first, second], "neat")
        crossed = OPERATORS.index("crossover")
        operator = jnp.where(second == NO_PARENT, varied.operator, crossed)
        varied = Children(varied.genotypes, varied.parents, operator)
        fresh = newcomers(self.newcomer, keys), neat.no_novelty(novelty, self.slots)
        offspring, novelty = or_newcomers(archive, (varied, novelty), fresh)
        return offspring, None, novelty

    def _crossed(self, archive: Elites, cell: Int[Array, ""], *, key: PRNGKeyArray):
        whether, which, cross_key = jax.random.split(jax.random.fold_in(key, 1), 3)
        other = draw(archive, self.select, key=which)
        happens = jax.random.bernoulli(whether, self.crossover) & (other != cell)
        fitter = archive.fitness[cell] >= archive.fitness[other]
        pair = jnp.where(fitter, cell, other), jnp.where(fitter, other, cell)
        one, two = (_network(archive, chosen) for chosen in pair)
        crossed = neat.crossover(one, two, key=cross_key)
        parent = _network(archive, cell)
        parent = jax.tree.map(lambda a, b: jnp.where(happens, a, b), crossed, parent)
        return parent, jnp.where(happens, other, NO_PARENT)


def _network(archive: Elites, cell: Int[Array, ""]) -> Graph:
    network = jax.tree.map(lambda x: x[cell], archive.genotypes)
    assert isinstance(network, Graph)
    return network
