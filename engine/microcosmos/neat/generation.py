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
from .rows import NONE, barrier, below, draws
from .settings import Settings
from .species import Species, divide, no_species


class Ranking(eqx.Module):
    """The population ordered by species, and by fitness within each."""

    order: Int[Array, "individual"]
    start: Int[Array, "species"]
    """Start of each species in the order."""
    valid: Int[Array, "species"]
    """Number of members with finite fitness, which come first."""
    best: Float[Array, "species"]
    """Highest fitness, or −inf."""


def ranking(species: Species, fitness: Float[Array, "individual"]) -> Ranking:
    """Rank networks within species: ties by index, non-finite fitness last."""
    order = jnp.lexsort((-fitness, species.of))
    start = jnp.cumsum(species.members) - species.members
    valid = jnp.zeros_like(species.members).at[species.of].add(jnp.isfinite(fitness))
    best = jnp.full(species.best.shape, -jnp.inf, fitness.dtype).at[species.of].max(fitness)
    return Ranking(order, start, valid, best)


def recorded(species: Species, now: Ranking, generation: Int[Array, ""]) -> Species:
    """Record the best fitness of species and population in a generation."""
    better, higher = now.best > species.best, jnp.max(now.best) > species.peak
    return replace(
        species,
        best=jnp.where(better, now.best, species.best),
        improved=jnp.where(better, generation, species.improved),
        peak=jnp.where(higher, jnp.max(now.best), species.peak),
        peak_generation=jnp.where(higher, generation, species.peak_generation),
    )


def allowed(
    species: Species, now: Ranking, settings: Settings, generation: Int[Array, ""]
) -> tuple[Bool[Array, "species"], Species]:
    """Return a flag for each species that may have offspring, and species with updated clocks.

    Once the population stagnates, only the best two species may, and the clocks restart, as in
    the authors' program.
    """
    able = species.alive & (now.valid > 0)
    place = ranks(now.best)
    fresh = generation - species.improved < settings.stagnation
    active = able & (fresh | (place < max(1, settings.species_elitism)))
    if not settings.population_stagnation:
        return active, species
    stagnant = generation - species.peak_generation > settings.population_stagnation
    able = jnp.where(stagnant, able & (place < 2), active)
    restarted = replace(
        species,
        improved=jnp.where(stagnant & able, generation, species.improved),
        peak_generation=jnp.where(stagnant, generation, species.peak_generation),
    )
    return able, restarted


def shares(
    able: Bool[Array, "species"],
    fitness: Float[Array, "individual"],
    species: Species,
    now: Ranking,
    settings: Settings,
) -> Float[Array, "species"]:
    """Return the share of offspring of each species; shares sum to 1 if any may breed."""
    members = jnp.maximum(1, species.members)
    if settings.allotment == "rank":
        share = jnp.sum(able) - ranks(jnp.where(able, now.best, -jnp.inf))
    else:  # The sum of shared fitness f/n over n members, shifted so that none is negative.
        finite = jnp.isfinite(fitness)
        low = jnp.minimum(0, jnp.min(jnp.where(finite, fitness, 0)))
        given = jnp.where(finite, fitness - low, 0) / members[species.of]
        share = jnp.zeros_like(now.best).at[species.of].add(given)
    kept = jnp.where(able, species.members, 0)
    share = _normalised(jnp.where(able, share, 0), able)
    return (1 - settings.inertia) * share + settings.inertia * _normalised(kept, able)


def allot(
    share: Float[Array, "species"], able: Bool[Array, "species"], total: int, minimum: int
) -> Int[Array, "species"]:
    """Return numbers of offspring that sum to `total` exactly, each within 1 of its share.

    Each able species first gets `minimum` offspring, if `total` suffices.
    """
    count = jnp.maximum(1, jnp.sum(able))
    least = jnp.where(able, jnp.minimum(minimum, total // count), 0)
    rest = total - jnp.sum(least)
    # Rounding the ends of consecutive shares, not the shares, keeps the sum. Parallel sums may
    # round to a smaller end after a larger one, hence the running maximum.
    ends = jax.lax.cummax(jnp.cumsum(jnp.where(able, share, 0)))
    ends = jnp.round(ends / jnp.where(ends[-1] > 0, ends[-1], 1) * rest).astype(least.dtype)
    return least + jnp.diff(ends, prepend=0)


def ranks(values: Float[Array, "species"]) -> Int[Array, "species"]:
    """Return the rank of each value, 0 for the highest; ties by row."""
    order = jnp.argsort(-values, stable=True)
    return jnp.zeros_like(order).at[order].set(jnp.arange(len(order)))


def _normalised(share, able):
    """Scale shares to sum 1; equal shares where all are 0."""
    share = jnp.where(jnp.any(share > 0), share, able)
    return share / jnp.maximum(jnp.sum(share), jnp.finfo(jnp.float32).tiny)


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
    """Return offspring, species, counters, parents and operators of an evaluated population.

    It calls `breed`, `number` and `divide`, for a population with counters of its own.
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

    Also return these genes, the species among which the numbered offspring are divided, parents
    (individual, 2) and the codes of `OPERATORS`. Parents are indices in the population, the
    fitter first, −1 for none. Fitness is maximised. A network without finite fitness is never a
    parent; without any finite fitness the population stays. `generation` is the number of the
    given population.
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
    code = parentage.mutated + 2 * (parentage.other >= 0)  # A place in `OPERATORS`.
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
    # At least one network of a species is a parent, however small its share is.
    survivors = jnp.ceil(settings.survival * species.members).astype(now.valid.dtype)
    survivors = jnp.clip(survivors, 1, jnp.maximum(1, now.valid))
    (uniform,) = draws((len(slot), 6), key=key)

    def draw(of, uniform):
        return now.order[now.start[of] + below(survivors[of], uniform)]

    interspecies = uniform[:, 3] < settings.interspecies
    # Species with offspring first, so that a whole number below their count picks one of them.
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
    # If none has offspring the population stays, and so do its species.
    breeding = jnp.where(jnp.any(breeding), breeding, species.alive)
    species = replace(species, alive=breeding)
    if settings.representative == "nearest":
        return species
    (uniform,) = draws(breeding.shape, key=key)
    place = now.start + below(species.members, uniform)
    drawn = now.order[jnp.minimum(place, len(now.order) - 1)]
    return replace(species, representatives=jax.tree.map(lambda x: x[drawn], population))


def _either(first: Bool[Array, ""], a: Graph, b: Graph) -> Graph:
    return jax.tree.map(lambda x, y: jnp.where(first, x, y), a, b)
