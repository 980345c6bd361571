"""Learned axes: survivors by brute force, the schedule, and learning anew."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from elite_rows import AXES, candidates, same

from microcosmos import genomes, search
from microcosmos.archive import components

GRID = search.Grid(AXES)
COLUMNS = (0, 1, 2, 3)

insert = jax.jit(search.insert)


def batch(seed, count=60):
    """Rows with four measures, of which two are descriptors, and genomes that all differ."""

    def vectors(random, count):
        return genomes.Vector(jnp.asarray(random.normal(size=(count, 3)), jnp.float32))

    rows = candidates(vectors, count, seed, generation=seed)
    random = np.random.default_rng(seed)
    more = (random.normal(size=(count, 2)) + seed / 4).astype(np.float32)
    return replace(rows, measures=jnp.concatenate([rows.measures, jnp.asarray(more)], 1))


def new(**changes):
    given = {"bins": 4, "first": 4, "floors": (1e-6, 0.0, 0.0, 0.0)} | changes
    return search.learned_axes(GRID, COLUMNS, **given)


def nothing(container):
    one = jax.tree.map(lambda x: x[0], batch(0).genotypes)
    return search.no_elites(container.count, 4, one)


def filled(container, batches):
    """The archive and the container after generations counted from 1."""
    archive = nothing(container)
    for number in range(1, batches + 1):
        rows = batch(number)
        container = search.refreshed(container, archive, rows, number)
        archive, _ = insert(archive, rows, container)
    return archive, container


def names(elites):
    there = np.flatnonzero(elites.occupied)
    return set(zip(elites.generation[there].tolist(), elites.slot[there].tolist(), strict=True))


def permuted(rows, seed):
    order = np.random.default_rng(seed).permutation(len(rows.occupied))
    return jax.tree.map(lambda x: x[order], rows)


@pytest.mark.long
def test_axes_are_learned_in_the_first_generation_then_ever_more_rarely():
    container = filled(new(), 1)[1]
    assert [n for n in range(1, 100) if container.changes(n)] == [1, 4, 8, 16, 32, 64]
    assert all(new().changes(n) for n in range(1, 9)), "nothing has been learned yet"


@pytest.mark.long
def test_the_order_of_rows_makes_no_difference_to_the_axes():
    archive, container = filled(new(), 3)
    rows = batch(4)
    found = container.refreshed(archive, rows, 4)
    assert found.epoch == 2
    for seed in range(5):
        other = container.refreshed(permuted(archive, seed), permuted(rows, seed), 4)
        assert same(found, other)


def test_the_axes_are_those_of_sound_rows_of_archive_and_candidates():
    archive, container = filled(new(), 3)
    rows = replace(batch(4), fitness=batch(4).fitness.at[0].set(jnp.nan))
    found = container.refreshed(archive, rows, 4)
    sound = np.array(rows.occupied) & np.isfinite(rows.fitness)
    parts = [np.asarray(x.measures)[k] for x, k in ((archive, archive.occupied), (rows, sound))]
    values = components.scaled(np.concatenate(parts), found.floors)
    expected = components.learn(values, 2)
    np.testing.assert_allclose(found.learned.weights, expected.weights, atol=1e-6)
    np.testing.assert_allclose(found.learned.low, expected.low, atol=1e-5)
    place = found.coordinates(jnp.concatenate([jnp.asarray(x) for x in parts]))
    np.testing.assert_allclose(place, expected.coordinates(values), atol=1e-4)


@pytest.mark.long
def test_the_first_of_each_learned_cell_survives():
    archive, container = filled(new(), 6)
    rows = batch(9)
    after, _ = insert(archive, rows, container)
    pool = jax.tree.map(lambda *x: jnp.concatenate(x), archive, rows)
    cell, best = np.asarray(container.cell_of(jnp.asarray(pool.measures))), {}
    digest = np.asarray(search.digest(pool.genotypes)).tolist()
    for i in np.flatnonzero(pool.occupied):
        key = -float(pool.fitness[i]), *digest[i], int(pool.generation[i]), int(pool.slot[i])
        best[int(cell[i])] = min(best.get(int(cell[i]), key), key)
    assert names(after) == {key[-2:] for key in best.values()}


@pytest.mark.long
def test_learning_anew_displaces_and_never_duplicates():
    archive, container = filled(new(), 3)
    rows = replace(batch(4), occupied=jnp.zeros(60, bool))
    again = container.refreshed(archive, batch(40), 4)
    after, inserted = insert(archive, rows, again)
    assert not np.asarray(inserted.entered).any()
    assert names(after) < names(archive), "some share a cell of the new axes"
    kept = np.asarray(after.measures)[np.asarray(after.occupied)]
    cells = np.asarray(again.cell_of(jnp.asarray(kept)))
    assert len(set(cells.tolist())) == len(cells)


def test_too_few_rows_leave_the_container_as_it_was():
    few = jax.tree.map(lambda x: x[:3], replace(batch(1), occupied=jnp.ones(60, bool)))
    container = new()
    assert container.refreshed(nothing(container), few, 1) is container
    learned = filled(container, 1)[1]
    assert learned.refreshed(nothing(container), few, 4) is learned
