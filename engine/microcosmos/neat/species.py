"""Species: networks close to one representative (Stanley and Miikkulainen 2002)."""

from dataclasses import replace
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..genomes import BodyGraph, Graph
from .alignment import Coefficients
from .graphs import distance
from .settings import Settings

UNASSIGNED = -1


class Species(eqx.Module):
    """Rows of species, living ones first, older before younger."""

    representatives: Graph
    alive: Bool[Array, "species"]
    number: Int[Array, "species"]
    """Unique over the whole run."""
    best: Float[Array, "species"]
    """Highest fitness of any member so far; −inf before the first."""
    improved: Int[Array, "species"]
    """Generation in which `best` was reached, or the species was founded."""
    members: Int[Array, "species"]
    of: Int[Array, "individual"]
    """Row of the species of each network."""
    threshold: Float[Array, ""]
    """Compatibility distance to a representative."""
    next_number: Int[Array, ""]
    peak: Float[Array, ""]
    """Highest fitness in the population so far."""
    peak_generation: Int[Array, ""]


class Assignment(NamedTuple):
    """The species of each network while species are founded."""

    representatives: Graph
    count: Int[Array, ""]
    of: Int[Array, "individual"]
    nearest: Int[Array, "individual"]
    """Species with the nearest representative, compatible or not."""
    least: Float[Array, "individual"]
    """Distance to that representative."""
    closest: Int[Array, "species"]
    """Member nearest to each representative."""


def assign(
    population: Graph,
    representatives: Graph,
    count: Int[Array, ""],
    threshold: Float[Array, ""],
    coefficients: Coefficients,
) -> Assignment:
    """Assign each network to the first compatible species, or let it found one.

    This is the paper's rule. Once all rows are taken, a network compatible with none joins the
    species with the nearest representative.
    """
    individuals, dtype = size_and_type(population)
    rows, _ = size_and_type(representatives)

    def join(row, state: Assignment, founder=None) -> Assignment:
        one = jax.tree.map(lambda x: x[row], state.representatives)
        far = jax.vmap(lambda n: distance(n, one, coefficients))(population).astype(dtype)
        fits = far < threshold if founder is None else (far < threshold) | founder
        joins = (state.of == UNASSIGNED) & fits
        return state._replace(
            of=jnp.where(joins, row, state.of),
            nearest=jnp.where(far < state.least, row, state.nearest),
            least=jnp.minimum(far, state.least),
            closest=state.closest.at[row].set(jnp.argmin(jnp.where(joins, far, jnp.inf))),
        )

    def found_species(state: Assignment) -> Assignment:
        first = jnp.argmax(state.of == UNASSIGNED)
        founded = jax.tree.map(
            lambda all_, new: all_.at[state.count].set(new[first]),
            state.representatives,
            population,
        )
        state = state._replace(representatives=founded)
        # A founder joins its own species whatever the threshold.
        state = join(state.count, state, jnp.arange(individuals) == first)
        return state._replace(count=state.count + 1)

    def unfinished(state: Assignment) -> Bool[Array, ""]:
        return (state.count < rows) & jnp.any(state.of == UNASSIGNED)

    nobody = jnp.full(individuals, UNASSIGNED)
    far, no_members = jnp.full(individuals, jnp.inf, dtype), jnp.zeros(rows, nobody.dtype)
    none = (nobody, jnp.zeros_like(nobody), far, no_members)
    state = Assignment(representatives, count.astype(nobody.dtype), *none)
    state = jax.lax.fori_loop(0, state.count, join, state)
    state = jax.lax.while_loop(unfinished, found_species, state)
    return state._replace(of=jnp.where(state.of == UNASSIGNED, state.nearest, state.of))


def no_species(population: Graph, settings: Settings) -> Species:
    """Return empty species for a first population."""
    individuals, dtype = size_and_type(population)
    rows = min(settings.max_species, individuals)
    return Species(
        representatives=jax.tree.map(
            lambda x: jnp.zeros((rows, *x.shape[1:]), x.dtype), population
        ),
        alive=jnp.zeros(rows, bool),
        number=jnp.full(rows, UNASSIGNED, int),
        best=jnp.full(rows, -jnp.inf, dtype),
        improved=jnp.zeros(rows, int),
        members=jnp.zeros(rows, int),
        of=jnp.full(individuals, UNASSIGNED, int),
        threshold=jnp.asarray(settings.threshold, dtype),
        next_number=jnp.zeros((), int),
        peak=jnp.asarray(-jnp.inf, dtype),
        peak_generation=jnp.zeros((), int),
    )


def divide(
    population: Graph, species: Species, settings: Settings, generation: Int[Array, ""]
) -> Species:
    """Divide a population, evaluated in `generation`, into species.

    Species without members end. The member nearest to a representative becomes the next one,
    if the settings ask for it.
    """
    species = compacted(species)
    before = jnp.sum(species.alive)
    state = assign(
        population, species.representatives, before, species.threshold, settings.coefficients
    )
    row = jnp.arange(species.alive.shape[0])
    new = (row >= before) & (row < state.count)
    members = jnp.zeros_like(species.members).at[state.of].add(1)
    representatives = state.representatives
    if settings.representative == "nearest":
        representatives = jax.tree.map(
            lambda old, all_: jnp.where(_column(members > 0, old), all_[state.closest], old),
            representatives,
            population,
        )
    return compacted(
        replace(
            species,
            representatives=representatives,
            alive=members > 0,
            number=jnp.where(new, species.next_number + row - before, species.number),
            best=jnp.where(new, -jnp.inf, species.best),
            improved=jnp.where(new, generation, species.improved),
            members=members,
            of=state.of,
            next_number=species.next_number + state.count - before,
        )
    )


def compacted(species: Species) -> Species:
    """Move living rows to the front, in their order, and empty the others."""
    order = jnp.argsort(~species.alive, stable=True)
    place = jnp.zeros_like(order).at[order].set(jnp.arange(len(order)))
    alive = species.alive[order]
    return replace(
        species,
        representatives=jax.tree.map(
            lambda x: jnp.where(_column(alive, x), x[order], jnp.zeros((), x.dtype)),
            species.representatives,
        ),
        alive=alive,
        number=jnp.where(alive, species.number[order], UNASSIGNED),
        best=jnp.where(alive, species.best[order], -jnp.inf),
        improved=jnp.where(alive, species.improved[order], 0),
        members=jnp.where(alive, species.members[order], 0),
        of=jnp.where(species.of < 0, UNASSIGNED, place[species.of]),
    )


def size_and_type(population: Graph) -> tuple[int, Any]:
    """Return the number of genotypes, and the type of their weights."""
    network = population.network if isinstance(population, BodyGraph) else population
    return network.weight.shape[0], network.weight.dtype


def _column(flags, values):
    """Broadcast flags of rows over the values of each row."""
    return flags.reshape(-1, *[1] * (values.ndim - 1))
