"""How many children each species has (Stanley and Miikkulainen 2002, section 3.3)."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .settings import Settings
from .species import Species


class Standing(eqx.Module):
    """The population in order: species after species, in each the fittest first."""

    order: Int[Array, "individual"]
    start: Int[Array, "species"]
    """Where a species begins in the order."""
    valid: Int[Array, "species"]
    """Members with a finite fitness, which come first."""
    best: Float[Array, "species"]
    """The highest fitness, or −inf."""


def standing(species: Species, fitness: Float[Array, "individual"]) -> Standing:
    """Ranks within species; of equals the earlier one is first. Not finite is last."""
    order = jnp.lexsort((-fitness, species.of))
    start = jnp.cumsum(species.members) - species.members
    valid = jnp.zeros_like(species.members).at[species.of].add(jnp.isfinite(fitness))
    best = jnp.full(species.best.shape, -jnp.inf, fitness.dtype).at[species.of].max(fitness)
    return Standing(order, start, valid, best)


def recorded(species: Species, now: Standing, generation: Int[Array, ""]) -> Species:
    """The species with what their members reached in a generation."""
    better, higher = now.best > species.best, jnp.max(now.best) > species.peak
    return replace(
        species,
        best=jnp.where(better, now.best, species.best),
        improved=jnp.where(better, generation, species.improved),
        peak=jnp.where(higher, jnp.max(now.best), species.peak),
        peak_generation=jnp.where(higher, generation, species.peak_generation),
    )


def allowed(
    species: Species, now: Standing, settings: Settings, generation: Int[Array, ""]
) -> tuple[Bool[Array, "species"], Species]:
    """The species that may have children.

    Once the population stagnates, its clock and those of the two species start anew, as in the
    authors' program.
    """
    able = species.alive & (now.valid > 0)
    place = places(now.best)
    fresh = generation - species.improved < settings.stagnation
    lively = able & (fresh | (place < max(1, settings.species_elitism)))
    if not settings.population_stagnation:
        return lively, species
    stuck = generation - species.peak_generation > settings.population_stagnation
    able = jnp.where(stuck, able & (place < 2), lively)
    again = replace(
        species,
        improved=jnp.where(stuck & able, generation, species.improved),
        peak_generation=jnp.where(stuck, generation, species.peak_generation),
    )
    return able, again


def shares(
    able: Bool[Array, "species"],
    fitness: Float[Array, "individual"],
    species: Species,
    now: Standing,
    settings: Settings,
) -> Float[Array, "species"]:
    """The share of all children that each species gets; they sum to 1 where any is able."""
    members = jnp.maximum(1, species.members)
    if settings.allotment == "rank":
        share = jnp.sum(able) - places(jnp.where(able, now.best, -jnp.inf))
    else:  # The sum of shared fitness f/n over n members; negative ones are moved to 0.
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
    """Whole numbers of children that sum to `total` exactly, each within 1 of its share.

    Ends of consecutive shares are rounded. `minimum` children of each able species come
    first, as far as there is room.
    """
    count = jnp.maximum(1, jnp.sum(able))
    least = jnp.where(able, jnp.minimum(minimum, total // count), 0)
    rest = total - jnp.sum(least)
    ends = jax.lax.cummax(jnp.cumsum(jnp.where(able, share, 0)))
    ends = jnp.round(ends / jnp.where(ends[-1] > 0, ends[-1], 1) * rest).astype(least.dtype)
    return least + jnp.diff(ends, prepend=0)


def places(values: Float[Array, "species"]) -> Int[Array, "species"]:
    """0 for the highest value and so on; of equals the earlier row is first."""
    order = jnp.argsort(-values, stable=True)
    return jnp.zeros_like(order).at[order].set(jnp.arange(len(order)))


def _normalised(share, able):
    """Shares that sum to 1, equal ones where all are 0."""
    share = jnp.where(jnp.any(share > 0), share, able)
    return share / jnp.maximum(jnp.sum(share), jnp.finfo(jnp.float32).tiny)
