"""Insertion into cells by a total order, independent of the order of arrival."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import DTypeLike
from jaxtyping import Array, Bool, Float, Int, UInt32

from ..device import array
from ..genomes import Genotype, words
from .cells import Axis, Cells

MAX_INT = np.int32(np.iinfo(np.int32).max)
SIGN_BIT = np.uint32(1 << 31)
"""Flipping this bit maps unsigned integers to signed ones in the same order."""


class Elites(eqx.Module):
    """One row for each cell (or candidate); rows that are not `occupied` are empty."""

    occupied: Bool[Array, "row"]
    fitness: Float[Array, "row"]
    measures: Float[Array, "row measure"]
    generation: Int[Array, "row"]
    slot: Int[Array, "row"]
    curiosity: Float[Array, "row"]
    """Score as a parent: 1 at first, more where children have entered; see `selection`."""
    genotypes: Genotype


def no_elites(cells: int, measures: int, genotype: Genotype) -> Elites:
    """Return an archive without any elite, for genotypes shaped as the given one."""
    return Elites(
        occupied=zeros(bool, cells),
        fitness=zeros(np.float32, cells),
        measures=zeros(np.float32, cells, measures),
        generation=zeros(np.int32, cells),
        slot=zeros(np.int32, cells),
        curiosity=zeros(np.float32, cells),
        genotypes=jax.tree.map(lambda x: zeros(x.dtype, cells, *x.shape), genotype),
    )


def zeros(dtype: DTypeLike, *shape: int) -> Array:
    """Return zeros from the host: `jnp.zeros` compiles a program for each shape."""
    return array(np.zeros(shape, dtype))


def candidates(
    generation: int | Int[Array, ""],
    genotypes: Genotype,
    fitness: Float[Array, "row"],
    measures: Float[Array, "row measure"],
    feasible: Bool[Array, "row"],
) -> Elites:
    """Return the creatures of a generation as candidates; infeasible ones never enter."""
    rows = len(fitness)
    slots = jnp.arange(rows, dtype=jnp.int32)
    generations = jnp.full(rows, generation, jnp.int32)
    ones = jnp.ones(rows, jnp.float32)
    return Elites(feasible, fitness, measures, generations, slots, ones, genotypes)


class Inserted(eqx.Module):
    """The result of insertion for each candidate."""

    cell: Int[Array, "row"]
    """Cells; the number of cells for rows that cannot enter any."""
    entered: Bool[Array, "row"]
    fresh: Bool[Array, "row"]
    """True if the cell was empty before."""
    improvement: Float[Array, "row"]
    """Fitness above the cell's earlier elite; above 0 if the cell was empty."""


def clipped(candidates: Elites, axes: tuple[Axis, ...]) -> int:
    """Count the feasible candidates beyond an end of an axis; its outer bins take them."""
    beyond = np.zeros(len(candidates.occupied), bool)
    for axis in axes:
        value = np.asarray(candidates.measures)[:, axis.measure]
        beyond |= (value < axis.low) | (value > axis.high)
    return int(np.count_nonzero(beyond & np.asarray(candidates.occupied)))


def insert_into_cells(
    archive: Elites, candidates: Elites, cells: Cells
) -> tuple[Elites, Inserted]:
    """Return the archive with the best of each cell, and the result for each candidate; see
    `insert`."""
    count, rows = archive.occupied.shape[0], candidates.occupied.shape[0]
    able = sound(candidates, cells.axes)
    cell = jnp.where(able, cells.of(candidates.measures), count)
    home = jnp.minimum(cell, count - 1)
    fresh = able & ~archive.occupied[home]
    entered = _winners(archive, candidates, cell, home, able)
    # Rows that do not enter get distinct indices beyond the archive, which are dropped.
    place = jnp.where(entered, cell, count + jnp.arange(rows))
    before = jnp.where(fresh, 0.0, archive.fitness[home])
    improvement = jnp.where(able, candidates.fitness - before, -jnp.inf)
    archive = jax.tree.map(
        lambda old, new: old.at[place].set(new, mode="drop", unique_indices=True),
        archive,
        candidates,
    )
    return archive, Inserted(cell, entered, fresh, improvement)


def sound(candidates: Elites, axes: tuple[Axis, ...]) -> Bool[Array, "row"]:
    """Return the candidates that may enter: feasible, with finite fitness and descriptors."""
    # A NaN would win every maximum of its cell. QDax loses a better offspring of the same batch
    # that way; tests/engine/search/test_insertion.py, "odd numbers", compares.
    able = candidates.occupied & jnp.isfinite(candidates.fitness)
    descriptors = jnp.stack([candidates.measures[:, axis.measure] for axis in axes], 1)
    return able & jnp.all(jnp.isfinite(descriptors), 1)


def ranked(rows: Elites) -> tuple[Int[Array, "row"], Bool[Array, "row"]]:
    """Return each row's position in the total order, and whether no earlier row has its genes.

    Rows that are not `occupied` come last.
    """
    first, second, generation, slot = _rank(rows)
    unfit = jnp.where(rows.occupied, -height(rows.fitness), MAX_INT)
    order = jnp.lexsort((slot, generation, second, first, unfit))
    index = jnp.arange(len(order), dtype=jnp.int32)
    position = jnp.zeros_like(index).at[order].set(index)
    alike = jnp.lexsort((position, second, first))
    equal = (first[alike[1:]] == first[alike[:-1]]) & (second[alike[1:]] == second[alike[:-1]])
    repeated = jnp.concatenate([jnp.zeros(1, bool), equal])
    return position, ~jnp.zeros(len(order), bool).at[alike].set(repeated)


def height(fitness: Float[Array, "row"]) -> Int[Array, "row"]:
    """Map finite float32 numbers to integers in the same order, −0 as 0, denormals too."""
    bits = jax.lax.bitcast_convert_type(fitness.astype(jnp.float32), jnp.int32)
    return jnp.where(bits < 0, -(bits & MAX_INT), bits)


def digest(genotypes: Genotype) -> UInt32[Array, "row 2"]:
    """Return 64 bits that depend on every used gene, −0 counting as 0."""
    genes = words(genotypes)
    return jnp.stack([_mix(genes, salt) for salt in (0x9E3779B9, 0x85EBCA6B)], 1)


def _mix(words: UInt32[Array, "row word"], salt: int) -> UInt32[Array, "row"]:
    """Sum avalanched words (the finaliser of MurmurHash3), each salted by its place."""
    place = (jnp.arange(words.shape[1], dtype=jnp.uint32) + 1) * jnp.uint32(salt)
    h = words ^ place[None]
    h = (h ^ (h >> 16)) * jnp.uint32(0x85EBCA6B)
    h = (h ^ (h >> 13)) * jnp.uint32(0xC2B2AE35)
    h = (h ^ (h >> 16)) * (place | 1)[None]
    return jnp.sum(h, 1, dtype=jnp.uint32)


def _winners(
    archive: Elites,
    candidates: Elites,
    cell: Int[Array, "row"],
    home: Int[Array, "row"],
    able: Bool[Array, "row"],
) -> Bool[Array, "row"]:
    """Return the candidates that rank above their cell's elite and its other candidates.

    Genes decide only at equal fitness.
    """
    count = archive.occupied.shape[0]
    elite = jnp.where(archive.occupied, height(archive.fitness), -MAX_INT)
    own = height(candidates.fitness)
    best = elite.at[cell].max(own, mode="drop")
    leads = able & (own == best[home])
    leaders = jnp.zeros(count, jnp.int32).at[cell].add(leads.astype(jnp.int32), mode="drop")
    ties = leads & ((leaders[home] > 1) | (own == elite[home]))
    # Ties are rare, and a digest reads every gene.
    return jax.lax.cond(
        jnp.any(ties),
        lambda: _untied(archive, candidates, cell, home, leads, own == elite[home]),
        lambda: leads,
    )


def _untied(
    archive: Elites,
    candidates: Elites,
    cell: Int[Array, "row"],
    home: Int[Array, "row"],
    leads: Bool[Array, "row"],
    level: Bool[Array, "row"],
) -> Bool[Array, "row"]:
    """Return the first of equally fit leaders by digest, generation and slot.

    `level` marks rows whose cell's elite is equally fit.
    """
    count = archive.occupied.shape[0]
    incumbents = jax.tree.map(lambda x: x[home], archive)
    rivals = level & leads
    for mine, theirs in zip(_rank(candidates), _rank(incumbents), strict=True):
        least = jnp.full(count, MAX_INT)
        least = least.at[jnp.where(leads, cell, count)].min(mine, mode="drop")
        least = least.at[jnp.where(rivals, cell, count)].min(theirs, mode="drop")
        leads &= mine == least[home]
        rivals &= theirs == least[home]
    # A row that equals the elite in every key is that elite. The first of equal rows wins.
    row = jnp.arange(len(leads), dtype=jnp.int32)
    first = jnp.full(count, MAX_INT).at[jnp.where(leads, cell, count)].min(row, mode="drop")
    return leads & ~rivals & (row == first[home])


def _rank(elites: Elites) -> tuple[Int[Array, "row"], ...]:
    """Return the keys of the order at equal fitness, first keys first; smaller is better."""
    ordered = jax.lax.bitcast_convert_type(digest(elites.genotypes) ^ SIGN_BIT, jnp.int32)
    return ordered[:, 0], ordered[:, 1], elites.generation, elites.slot
