"""Number of offspring of each species (Stanley and Miikkulainen 2002, section 3.3)."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .settings import Settings
from .species import Species


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
    """Return which species may have offspring, and the species with updated clocks.

    Once the population stagnates, only the best two may, and the clocks restart, as in the
    authors' program.
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

    Ends of consecutive shares are rounded. Each able species first gets `minimum` offspring,
    if `total` suffices.
    """
    count = jnp.maximum(1, jnp.sum(able))
    least = jnp.where(able, jnp.minimum(minimum, total // count), 0)
    rest = total - jnp.sum(least)
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
