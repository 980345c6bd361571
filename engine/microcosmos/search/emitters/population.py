"""NEAT with its own population: parents are its networks; the archive only records."""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ... import neat
from ...genomes import CPPN
from ..insertion import Elites
from .elites import Newcomer, parentless
from .emitter import NO_PARENT, OPERATORS, Children, Keys, Outcome

CODES = np.array(
    [OPERATORS.index(name) for name in ("copy", "neat", "crossover", "crossover")], np.int32
)
"""Our operator code for each of NEAT's."""


class Population(eqx.Module):
    """The networks of a generation, their fitness once measured, and their species."""

    networks: CPPN
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

    def init(self, *, key: PRNGKeyArray) -> Population:
        keys = jax.random.split(key, self.slots)
        networks = jax.vmap(lambda own: self.newcomer(key=own))(keys)
        return Population(
            networks=networks,
            fitness=jnp.full(self.slots, -jnp.inf, networks.weight.dtype),
            species=neat.first_species(networks, self.settings),
            age=jnp.zeros((), jnp.int32),
        )

    def founded(self, state: Population, networks: CPPN) -> Population:
        """Return the state with given networks in place of the first newcomers."""
        count = networks.weight.shape[0]
        networks = jax.tree.map(lambda a, b: a.at[:count].set(b), state.networks, networks)
        species = neat.first_species(networks, self.settings)
        return replace(state, networks=networks, species=species)

    def emit(
        self, state: Population, archive: Elites, counters: neat.Counters, *, keys: Keys
    ) -> tuple[Children, Population, neat.Counters]:
        """Return the newcomers first, then the children of the generation before."""
        cells = archive.occupied.shape[0]
        first = parentless(state.networks, self.slots, "random"), state.species, counters

        def breed():
            networks, species, numbered, parents, code = neat.next_generation(
                state.networks,
                state.fitness,
                state.species,
                counters,
                self.settings,
                inputs=self.inputs,
                outputs=self.outputs,
                key=keys[0],
                generation=state.age - 1,
            )
            parents = jnp.where(parents < 0, NO_PARENT, parents + cells).astype(jnp.int32)
            return Children(networks, parents, jnp.asarray(CODES)[code]), species, numbered

        children, species, counters = jax.lax.cond(state.age > 0, breed, lambda: first)
        fitness = jnp.full_like(state.fitness, -jnp.inf)
        grown = Population(children.genotypes, fitness, species, state.age + 1)
        return children, grown, counters

    def tell(self, state: Population, outcome: Outcome) -> Population:
        return replace(state, fitness=jnp.where(outcome.feasible, outcome.fitness, -jnp.inf))
