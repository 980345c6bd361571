"""The next generation of a NEAT population (Stanley and Miikkulainen 2002)."""

from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..genomes import CPPN
from .crossover import crossover
from .mutation import Novelty, mutate
from .numbering import Counters, number
from .offspring import Standing, allot, allowed, recorded, shares, standing
from .rng import below, draws
from .rows import NONE, apart
from .settings import Settings
from .species import Species, divide, no_species

OPERATORS = ("copy", "mutation", "crossover", "crossover+mutation")
"""How a network of the next generation arose, by operator code."""


class Offspring(eqx.Module):
    """From whom each network of the next generation comes, and how."""

    parent: Int[Array, "individual"]
    other: Int[Array, "individual"]
    """The less fit of two parents, or −1."""
    mutated: Bool[Array, "individual"]


@partial(jax.jit, static_argnames="settings")
def first_species(population: CPPN, settings: Settings) -> Species:
    """The species of a first population, which is evaluated in generation 0."""
    rows = min(settings.max_species, population.weight.shape[0])
    return divide(
        population,
        no_species(population, rows, settings.threshold),
        settings.coefficients,
        nearest=settings.representative == "nearest",
        generation=jnp.zeros((), int),
    )


def next_generation(
    population: CPPN,
    fitness: Float[Array, "individual"],
    species: Species,
    counters: Counters,
    settings: Settings,
    *,
    inputs: int,
    outputs: int,
    key: PRNGKeyArray,
    generation: Int[Array, ""],
) -> tuple[CPPN, Species, Counters, Int[Array, "individual 2"], Int[Array, "individual"]]:
    """The children of an evaluated population, and how they arose.

    Fitness is maximised. What is not finite counts worst and is never a parent; where nothing
    is finite the population stays. `generation` is the number of the population that comes
    in. Also the parents, as places in that population (the fitter first, −1 for none), and
    the operators' codes.
    """
    parents_key, children_key, species_key = jax.random.split(
        jax.random.fold_in(key, generation), 3
    )
    fitness = jnp.where(jnp.isfinite(fitness), fitness, -jnp.inf)
    now = standing(species, fitness)
    species = recorded(species, now, generation)
    able, species = allowed(species, now, settings, generation)
    share = shares(able, fitness, species, now, settings)
    sizes = allot(share, able, len(fitness), settings.min_size)
    offspring = breed(sizes, fitness, species, now, settings, key=parents_key)
    children, novelty = bear(population, offspring, settings, inputs, outputs, key=children_key)
    children, novelty = apart((children, novelty))
    children, counters = apart(number(children, novelty, counters))
    species = _represented(population, species, sizes > 0, now, settings, key=species_key)
    species = divide(
        children,
        species,
        settings.coefficients,
        nearest=settings.representative == "nearest",
        generation=generation + 1,
    )
    code = offspring.mutated + 2 * (offspring.other >= 0)
    return children, species, counters, jnp.stack([offspring.parent, offspring.other], 1), code


def breed(
    sizes: Int[Array, "species"],
    fitness: Float[Array, "individual"],
    species: Species,
    now: Standing,
    settings: Settings,
    *,
    key: PRNGKeyArray,
) -> Offspring:
    """Slots are given to species in turn: first their elites, then their children."""
    slot = jnp.arange(len(fitness))
    ends = jnp.cumsum(sizes)
    own = jnp.minimum(jnp.searchsorted(ends, slot, side="right"), len(sizes) - 1)
    rank = slot - (ends - sizes)[own]
    elites = jnp.where(species.members >= settings.elite_size, settings.elites, 0)
    copied = rank < jnp.minimum(elites, now.valid)[own]
    survivors = jnp.ceil(settings.survival * species.members).astype(now.valid.dtype)
    survivors = jnp.clip(survivors, 1, jnp.maximum(1, now.valid))
    (uniform,) = draws((len(slot), 6), key=key)

    def draw(of, uniform):
        return now.order[now.start[of] + below(survivors[of], uniform)]

    abroad = uniform[:, 3] < settings.interspecies
    breeding = jnp.argsort(sizes == 0, stable=True)
    any_ = breeding[below(jnp.sum(sizes > 0), uniform[:, 4])]
    first, second = draw(own, uniform[:, 0]), draw(jnp.where(abroad, any_, own), uniform[:, 1])
    crossed = ~copied & (uniform[:, 2] < settings.crossover)
    fitter = jnp.where(fitness[first] >= fitness[second], first, second)
    lesser = jnp.where(fitness[first] >= fitness[second], second, first)
    elite = now.order[jnp.minimum(now.start[own] + rank, len(slot) - 1)]
    parent = jnp.where(copied, elite, jnp.where(crossed, fitter, first))
    mutated = ~copied & (~crossed | (uniform[:, 5] >= settings.crossover_only))
    hopeless = jnp.sum(sizes) == 0
    return Offspring(
        jnp.where(hopeless, slot, parent),
        jnp.where(crossed & ~hopeless, lesser, NONE),
        mutated & ~hopeless,
    )


def bear(
    population: CPPN,
    offspring: Offspring,
    settings: Settings,
    inputs: int,
    outputs: int,
    *,
    key: PRNGKeyArray,
) -> tuple[CPPN, Novelty]:
    """The networks of a offspring, without numbers for what is new in them."""

    def child(one, other, crosses, mutated, keys):
        crossed = crossover(one, other, settings.average, settings.disabled, key=keys[0])
        one = apart(_either(crosses, crossed, one))
        varied, novelty = mutate(one, settings.rates, inputs, outputs, key=keys[1])
        novelty = jax.tree.map(lambda row: jnp.where(mutated, row, NONE), novelty)
        return _either(mutated, varied, one), novelty

    parents = jax.tree.map(lambda x: x[offspring.parent], population)
    others = jax.tree.map(lambda x: x[offspring.other], population)
    keys = jax.random.split(key, (len(offspring.parent), 2))
    return jax.vmap(child)(parents, others, offspring.other >= 0, offspring.mutated, keys)


def _represented(
    population: CPPN,
    species: Species,
    breeding: Bool[Array, "species"],
    now: Standing,
    settings: Settings,
    *,
    key: PRNGKeyArray,
) -> Species:
    """Species that bred, with members of the present population as representatives."""
    breeding = jnp.where(jnp.any(breeding), breeding, species.alive)
    species = replace(species, alive=breeding, threshold=_moved(species, settings))
    if settings.representative == "nearest":
        return species
    (uniform,) = draws(breeding.shape, key=key)
    place = now.start + below(species.members, uniform)
    drawn = now.order[jnp.minimum(place, len(now.order) - 1)]
    return replace(species, representatives=jax.tree.map(lambda x: x[drawn], population))


def _moved(species: Species, settings: Settings) -> Float[Array, ""]:
    """A threshold that follows the number of species, never below one step."""
    if not settings.target_species:
        return species.threshold
    excess = jnp.sign(jnp.sum(species.alive) - settings.target_species)
    moved = species.threshold + settings.threshold_step * excess
    return jnp.maximum(moved, settings.threshold_step).astype(species.threshold.dtype)


def _either(first: Bool[Array, ""], a: CPPN, b: CPPN) -> CPPN:
    return jax.tree.map(lambda x, y: jnp.where(first, x, y), a, b)
