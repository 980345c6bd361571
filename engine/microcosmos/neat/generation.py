"""The next generation of a NEAT population (Stanley and Miikkulainen 2002)."""

from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..genomes import Graph
from .graphs import crossover, mutate
from .mutation import Novelty
from .numbering import Counters, number
from .offspring import Ranking, allot, allowed, ranking, recorded, shares
from .rng import below, draws
from .rows import NONE, barrier
from .settings import Settings
from .species import Species, divide, no_species

OPERATORS = ("copy", "mutation", "crossover", "crossover+mutation")
"""Operators, by code."""


class Parentage(eqx.Module):
    """Parents of each network of the next generation."""

    parent: Int[Array, "individual"]
    other: Int[Array, "individual"]
    """Less fit of two parents, or −1."""
    mutated: Bool[Array, "individual"]


@partial(jax.jit, static_argnames="settings")
def first_species(population: Graph, settings: Settings) -> Species:
    """Divide the first population, evaluated in generation 0, into species."""
    empty = no_species(population, settings)
    return divide(population, empty, settings, jnp.zeros((), int))


def next_generation(
    population: Graph,
    fitness: Float[Array, "individual"],
    species: Species,
    counters: Counters,
    settings: Settings,
    *,
    inputs: int,
    outputs: int,
    key: PRNGKeyArray,
    generation: Int[Array, ""],
) -> tuple[Graph, Species, Counters, Int[Array, "individual 2"], Int[Array, "individual"]]:
    """Return the offspring of an evaluated population, species, counters, parents, operators.

    It is `breed`, `number` and `divide`, for a population that shares its counters with none.
    """
    children, novelty, species, parents, code = breed(
        population,
        fitness,
        species,
        settings,
        inputs=inputs,
        outputs=outputs,
        key=key,
        generation=generation,
    )
    children, counters = barrier(number(children, novelty, counters))
    species = divide(children, species, settings, generation + 1)
    return children, species, counters, parents, code


def breed(
    population: Graph,
    fitness: Float[Array, "individual"],
    species: Species,
    settings: Settings,
    *,
    inputs: int,
    outputs: int,
    key: PRNGKeyArray,
    generation: Int[Array, ""],
) -> tuple[Graph, Novelty, Species, Int[Array, "individual 2"], Int[Array, "individual"]]:
    """Return the offspring of an evaluated population, before their new genes have numbers.

    Also return these genes, the species to divide the numbered offspring into, parents and
    operators. Fitness is maximised. A network without finite fitness is never a parent; without
    any finite fitness the population stays. `generation` is the number of the given population.
    Parents are indices in it (the fitter first, −1 for none).
    """
    parents_key, children_key, species_key = jax.random.split(
        jax.random.fold_in(key, generation), 3
    )
    fitness = jnp.where(jnp.isfinite(fitness), fitness, -jnp.inf)
    now = ranking(species, fitness)
    species = recorded(species, now, generation)
    able, species = allowed(species, now, settings, generation)
    share = shares(able, fitness, species, now, settings)
    sizes = allot(share, able, len(fitness), settings.min_size)
    parentage = choose_parents(sizes, fitness, species, now, settings, key=parents_key)
    children, novelty = reproduce(
        population, parentage, settings, inputs, outputs, key=children_key
    )
    children, novelty = barrier((children, novelty))
    species = _renew_species(population, species, sizes > 0, now, settings, key=species_key)
    code = parentage.mutated + 2 * (parentage.other >= 0)
    parents = jnp.stack([parentage.parent, parentage.other], 1)
    return children, novelty, species, parents, code


def choose_parents(
    sizes: Int[Array, "species"],
    fitness: Float[Array, "individual"],
    species: Species,
    now: Ranking,
    settings: Settings,
    *,
    key: PRNGKeyArray,
) -> Parentage:
    """Fill the slots of each species: first copies of its elites, then offspring."""
    slot = jnp.arange(len(fitness))
    ends = jnp.cumsum(sizes)
    species_of = jnp.minimum(jnp.searchsorted(ends, slot, side="right"), len(sizes) - 1)
    rank = slot - (ends - sizes)[species_of]
    elites = jnp.where(species.members >= settings.elite_size, settings.elites, 0)
    copied = rank < jnp.minimum(elites, now.valid)[species_of]
    survivors = jnp.ceil(settings.survival * species.members).astype(now.valid.dtype)
    survivors = jnp.clip(survivors, 1, jnp.maximum(1, now.valid))
    (uniform,) = draws((len(slot), 6), key=key)

    def draw(of, uniform):
        return now.order[now.start[of] + below(survivors[of], uniform)]

    interspecies = uniform[:, 3] < settings.interspecies
    breeding = jnp.argsort(sizes == 0, stable=True)
    any_ = breeding[below(jnp.sum(sizes > 0), uniform[:, 4])]
    first = draw(species_of, uniform[:, 0])
    second = draw(jnp.where(interspecies, any_, species_of), uniform[:, 1])
    crossed = ~copied & (uniform[:, 2] < settings.crossover)
    fitter = jnp.where(fitness[first] >= fitness[second], first, second)
    lesser = jnp.where(fitness[first] >= fitness[second], second, first)
    elite = now.order[jnp.minimum(now.start[species_of] + rank, len(slot) - 1)]
    parent = jnp.where(copied, elite, jnp.where(crossed, fitter, first))
    mutated = ~copied & (~crossed | (uniform[:, 5] >= settings.crossover_only))
    extinct = jnp.sum(sizes) == 0
    return Parentage(
        jnp.where(extinct, slot, parent),
        jnp.where(crossed & ~extinct, lesser, NONE),
        mutated & ~extinct,
    )


def reproduce(
    population: Graph,
    parentage: Parentage,
    settings: Settings,
    inputs: int,
    outputs: int,
    *,
    key: PRNGKeyArray,
) -> tuple[Graph, Novelty]:
    """Return the offspring, whose new genes have no numbers yet."""

    def child(one, other, crosses, mutated, keys):
        crossed = crossover(one, other, settings.average, settings.disabled, key=keys[0])
        one = barrier(_either(crosses, crossed, one))
        varied, novelty = mutate(one, settings.rates, inputs, outputs, key=keys[1])
        novelty = jax.tree.map(lambda row: jnp.where(mutated, row, NONE), novelty)
        return _either(mutated, varied, one), novelty

    parents = jax.tree.map(lambda x: x[parentage.parent], population)
    others = jax.tree.map(lambda x: x[parentage.other], population)
    keys = jax.random.split(key, (len(parentage.parent), 2))
    return jax.vmap(child)(parents, others, parentage.other >= 0, parentage.mutated, keys)


def _renew_species(
    population: Graph,
    species: Species,
    breeding: Bool[Array, "species"],
    now: Ranking,
    settings: Settings,
    *,
    key: PRNGKeyArray,
) -> Species:
    """Keep the species with offspring; choose members of this population as representatives."""
    breeding = jnp.where(jnp.any(breeding), breeding, species.alive)
    species = replace(species, alive=breeding, threshold=_adjusted_threshold(species, settings))
    if settings.representative == "nearest":
        return species
    (uniform,) = draws(breeding.shape, key=key)
    place = now.start + below(species.members, uniform)
    drawn = now.order[jnp.minimum(place, len(now.order) - 1)]
    return replace(species, representatives=jax.tree.map(lambda x: x[drawn], population))


def _adjusted_threshold(species: Species, settings: Settings) -> Float[Array, ""]:
    """Adjust the threshold towards the target number of species, at least one step."""
    if not settings.target_species:
        return species.threshold
    excess = jnp.sign(jnp.sum(species.alive) - settings.target_species)
    moved = species.threshold + settings.threshold_step * excess
    return jnp.maximum(moved, settings.threshold_step).astype(species.threshold.dtype)


def _either(first: Bool[Array, ""], a: Graph, b: Graph) -> Graph:
    return jax.tree.map(lambda x, y: jnp.where(first, x, y), a, b)
