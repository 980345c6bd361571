"""Insertion into a grid of cells by a total order, independent of the order of arrival."""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from ..genomes import Genotype, words


@dataclass(frozen=True)
class Axis:
    """One descriptor's bins; `feature` is its column among the features."""

    feature: int
    low: float
    high: float
    bins: int
    logarithmic: bool

    def bin(self, value: Float[Array, "*batch"]) -> Int[Array, "*batch"]:
        """Half-open bins; what lies beyond an end counts in the last one there."""
        low, high = self.low, self.high
        value = jnp.clip(value, low, high)
        if self.logarithmic:
            low, high, value = np.log10(low), np.log10(high), jnp.log10(value)
        place = jnp.floor((value - low) / (high - low) * self.bins)
        return jnp.clip(place, 0, self.bins - 1).astype(jnp.int32)


class Elites(eqx.Module):
    """One row for each cell (or candidate); rows that are not `occupied` hold nothing."""

    occupied: Bool[Array, "row"]
    fitness: Float[Array, "row"]
    features: Float[Array, "row feature"]
    generation: Int[Array, "row"]
    slot: Int[Array, "row"]
    digest: UInt32[Array, "row 2"]
    genotypes: Genotype


def no_elites(cells: int, features: int, genotype: Genotype) -> Elites:
    """An archive without any elite, for genotypes shaped as the one given."""
    return Elites(
        occupied=jnp.zeros(cells, bool),
        fitness=jnp.zeros(cells, jnp.float32),
        features=jnp.zeros((cells, features), jnp.float32),
        generation=jnp.zeros(cells, jnp.int32),
        slot=jnp.zeros(cells, jnp.int32),
        digest=jnp.zeros((cells, 2), jnp.uint32),
        genotypes=jax.tree.map(lambda x: jnp.zeros((cells, *x.shape), x.dtype), genotype),
    )


def cells_of(
    features: Float[Array, "row feature"], axes: tuple[Axis, ...]
) -> Int[Array, "row"]:
    """Cell numbers in C order, the last descriptor fastest."""
    cell = jnp.zeros(features.shape[0], jnp.int32)
    for axis in axes:
        cell = cell * axis.bins + axis.bin(features[:, axis.feature])
    return cell


class Inserted(eqx.Module):
    """What became of candidates."""

    cell: Int[Array, "row"]
    """Their cells; the number of cells for rows that are not `occupied`."""
    entered: Bool[Array, "row"]
    fresh: Bool[Array, "row"]
    """Whether the cell was empty before."""
    improvement: Float[Array, "row"]
    """Fitness above the cell's earlier elite; above 0 where there was none."""


def clipped(candidates: Elites, axes: tuple[Axis, ...]) -> int:
    """How many sound candidates lie beyond an end of an axis, and count in its last bin."""
    beyond = np.zeros(len(candidates.occupied), bool)
    for axis in axes:
        value = np.asarray(candidates.features)[:, axis.feature]
        beyond |= (value < axis.low) | (value > axis.high)
    return int(np.count_nonzero(beyond & np.asarray(candidates.occupied)))


def insert(
    archive: Elites, candidates: Elites, axes: tuple[Axis, ...]
) -> tuple[Elites, Inserted]:
    """The archive with each cell's best, and what became of each candidate.

    The order is total: fitness, then the smaller digest of the genome, then the earlier
    generation and slot. So equal creatures and equal fitness give the same archive on every
    device. Candidates that are not `occupied` never enter.
    """
    cells, rows = archive.occupied.shape[0], candidates.occupied.shape[0]
    cell = jnp.where(candidates.occupied, cells_of(candidates.features, axes), cells)
    order = jnp.lexsort((*reversed(_rank(candidates)), cell))
    ordered = cell[order]
    first = (ordered != jnp.roll(ordered, 1)).at[0].set(True) & (ordered < cells)
    best = jnp.zeros(rows, bool).at[order].set(first)
    incumbent = jax.tree.map(lambda x: x[jnp.minimum(cell, cells - 1)], archive)
    fresh = ~incumbent.occupied & candidates.occupied
    entered = best & (fresh | _before(_rank(candidates), _rank(incumbent)))
    place = jnp.where(entered, cell, cells)
    archive = jax.tree.map(
        lambda old, new: old.at[place].set(new, mode="drop"), archive, candidates
    )
    before = jnp.where(fresh, 0.0, incumbent.fitness)
    improvement = jnp.where(candidates.occupied, candidates.fitness - before, -jnp.inf)
    return archive, Inserted(cell, entered, fresh, improvement)


def named(elites: Elites) -> Elites:
    """The same rows with the digests of their genotypes."""
    return replace(elites, digest=digest(elites.genotypes))


def digest(genotypes: Genotype) -> UInt32[Array, "row 2"]:
    """64 bits that depend on every used gene, −0 counting as 0."""
    said = words(genotypes)
    return jnp.stack([_mix(said, salt) for salt in (0x9E3779B9, 0x85EBCA6B)], 1)


def _mix(words: UInt32[Array, "row word"], salt: int) -> UInt32[Array, "row"]:
    """A sum of avalanched words (the finaliser of MurmurHash3), each salted by its place."""
    place = (jnp.arange(words.shape[1], dtype=jnp.uint32) + 1) * jnp.uint32(salt)
    h = words ^ place[None]
    h = (h ^ (h >> 16)) * jnp.uint32(0x85EBCA6B)
    h = (h ^ (h >> 13)) * jnp.uint32(0xC2B2AE35)
    h = (h ^ (h >> 16)) * (place | 1)[None]
    return jnp.sum(h, 1, dtype=jnp.uint32)


def _rank(elites: Elites) -> tuple[Array, ...]:
    """Keys of the total order, the most important first; smaller is better."""
    return (
        -elites.fitness,
        elites.digest[:, 0],
        elites.digest[:, 1],
        elites.generation,
        elites.slot,
    )


def _before(a: tuple[Array, ...], b: tuple[Array, ...]) -> Bool[Array, "row"]:
    """Lexicographic a < b."""
    less = jnp.zeros(a[0].shape, bool)
    for x, y in zip(reversed(a), reversed(b), strict=True):
        less = (x < y) | ((x == y) & less)
    return less
