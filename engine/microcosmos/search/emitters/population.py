"""NEAT with its own population: parents are its networks; the archive only records."""

from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ... import neat
from ...bounds import refuse_uncountable
from ...genomes import Graph
from ...operators import OPERATORS
from ..insertion import Elites
from .emitter import NO_PARENT, Children, Keys, Newcomer, Outcome, Problem, parentless

CODES = np.array(
    [OPERATORS.index(name) for name in ("copy", "neat", "crossover", "crossover")], np.int32
)
"""Our operator code for each of NEAT's."""


class Population(eqx.Module):
    """The networks measured last, their fitness, and their species.

    Once their children are emitted, the species are those that the children are divided into.
    """

    networks: Graph
    fitness: Float[Array, "slot"]
    species: neat.Species
    age: Int[Array, ""]
    """Generations emitted so far."""

    def sizes(self) -> dict[int, int]:
        """Return the number of members of each living species, by its number."""
        alive = np.asarray(self.species.alive)
        rows = (np.asarray(self.species.number), np.asarray(self.species.members))
        return dict(zip(*(row[alive].tolist() for row in rows), strict=True))


@dataclass(frozen=True)
class PopulationNeat:
    """NEAT with species, fitness sharing and crossover (Stanley and Miikkulainen 2002)."""

    slots: int
    newcomer: Newcomer
    settings: neat.Settings
    inputs: int
    outputs: int

    def __post_init__(self) -> None:
        refuse_uncountable(1, slots=self.slots, inputs=self.inputs, outputs=self.outputs)

    def init(self, *, key: PRNGKeyArray) -> Population:
        keys = jax.random.split(key, self.slots)
        networks = jax.vmap(lambda own: self.newcomer(key=own))(keys)
        species = neat.no_species(networks, self.settings)
        return Population(
            networks=networks,
            fitness=jnp.full(self.slots, -jnp.inf, species.best.dtype),
            species=species,
            age=jnp.zeros((), jnp.int32),
        )

    def emit(
        self, state: Population, archive: Elites, *, keys: Keys
    ) -> tuple[Children, Population, neat.Novelty]:
        """Return the newcomers first, then the children of the generation before."""
        cells = archive.occupied.shape[0]

        def breed():
            networks, novelty, species, parents, code = neat.breed(
                state.networks,
                state.fitness,
                state.species,
                self.settings,
                inputs=self.inputs,
                outputs=self.outputs,
                key=keys[0],
                generation=state.age - 1,
            )
            parents = jnp.where(parents < 0, NO_PARENT, parents + cells).astype(jnp.int32)
            return Children(networks, parents, jnp.asarray(CODES)[code]), species, novelty

        none = neat.no_novelty(jax.eval_shape(breed)[2], self.slots)
        first = parentless(state.networks, self.slots, "random"), state.species, none
        children, species, novelty = jax.lax.cond(state.age > 0, breed, lambda: first)
        return children, replace(state, species=species, age=state.age + 1), novelty

    def tell(self, state: Population, outcome: Outcome) -> Population:
        """Return the state with the children as its networks, divided by their numbers."""
        networks = outcome.genotypes
        assert isinstance(networks, Graph)
        species = neat.divide(networks, state.species, self.settings, state.age - 1)
        fitness = jnp.where(outcome.feasible, outcome.fitness, -jnp.inf)
        return replace(state, networks=networks, fitness=fitness, species=species)


def build_population(settings: Any, problem: Problem) -> PopulationNeat:
    whole, rates = neat.PRESETS[settings.preset], problem.rates
    if settings.preset != "paper":  # TensorNEAT's rates, over all activations.
        rates = replace(whole.rates, palette=rates.palette, recurrent=rates.recurrent)
    names = ("threshold", "stagnation", "survival", "crossover")
    given = {name: getattr(settings, name) for name in names}
    given = {name: value for name, value in given.items() if value is not None}
    chosen = replace(whole, rates=rates, population=problem.slots, **given)
    of_networks = problem.newcomer, chosen, problem.inputs, problem.outputs
    return PopulationNeat(problem.slots, *of_networks)
