"""Containers whose elites survive a competition of all, beside the written rules."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from elite_rows import AXES, awkward, candidates, same

from microcosmos import genomes, search

GRID = search.Grid(AXES)


def vectors(random, count):
    """Genotypes of which few are equal."""
    return genomes.Vector(jnp.asarray(random.integers(-4, 5, (count, 3)) / 4, jnp.float32))


LEARNED = search.learned_axes(GRID, (0, 1), bins=5, first=2, floors=(1e-6, 0.0))
CONTAINERS = {
    "dominated-novelty": search.DominatedNovelty(GRID, 20, 3),
    "fronts": search.Fronts(GRID, search.Axis(1, 0.0, 1.0, 1), 3),
    "unlearned": LEARNED,
    "learned": LEARNED.refreshed(*[candidates(vectors, 40, seed) for seed in (50, 51)], 1),
}

insert = jax.jit(search.insert)


@pytest.fixture(params=CONTAINERS)
def container(request):
    return CONTAINERS[request.param]


def batch(seed, kind=candidates, count=40):
    return kind(vectors, count, seed, generation=seed)


def nothing(container):
    one = jax.tree.map(lambda x: x[0], vectors(np.random.default_rng(0), 1))
    return search.no_elites(container.count, 2, one)


def names(elites):
    """The occupied places of each creature, by generation and slot."""
    there = np.flatnonzero(elites.occupied)
    born = zip(elites.generation[there].tolist(), elites.slot[there].tolist(), strict=True)
    return dict(zip(born, there.tolist(), strict=True))


def filled(container, kind=candidates, batches=6):
    archive = nothing(container)
    for seed in range(batches):
        archive, _ = insert(archive, batch(seed, kind), container)
    return archive


@pytest.mark.long
@pytest.mark.parametrize("kind", [candidates, awkward])
def test_the_order_of_candidates_makes_no_difference(container, kind):
    archive = filled(container, kind)
    rows = batch(99, kind)
    together, inserted = insert(archive, rows, container)
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(len(rows.occupied))
        shuffled = jax.tree.map(lambda x, order=order: x[order], rows)
        found, other = insert(archive, shuffled, container)
        assert same(together, found)
        assert same(jax.tree.map(lambda x, order=order: x[order], inserted), other)


def test_survivors_keep_their_places_and_newcomers_take_free_ones(container):
    archive = filled(container)
    for seed in range(10, 16):
        after, inserted = insert(archive, batch(seed), container)
        before, now = names(archive), names(after)
        assert all(now[one] == before[one] for one in now.keys() & before.keys())
        entered = np.asarray(inserted.entered)
        slots = np.flatnonzero(entered)
        assert {(seed, slot) for slot in slots.tolist()} == now.keys() - before.keys()
        places = np.asarray(inserted.cell)[slots]
        assert [now[seed, slot] for slot in slots.tolist()] == places.tolist()
        assert (np.asarray(inserted.cell)[~entered] == container.count).all()
        fresh = np.asarray(inserted.fresh)
        assert (fresh[slots] == ~np.asarray(archive.occupied)[places]).all()
        archive = after


def test_equal_genomes_survive_once(container):
    archive = filled(container)
    found = np.asarray(archive.genotypes.values)[np.asarray(archive.occupied)]
    assert len(np.unique(found, axis=0)) == len(found)


def by_rule(pool, position, neighbours):
    """Dominated novelty of each row, one after another."""
    place = np.asarray(search.places(pool.measures, AXES), float)
    found = np.full(len(place), -np.inf)
    for i in np.flatnonzero(pool.occupied):
        fitter = np.flatnonzero(np.asarray(pool.occupied) & (position < position[i]))
        apart = np.sort(np.linalg.norm(place[fitter] - place[i], axis=1))[:neighbours]
        found[i] = apart.mean() if len(apart) else np.inf
    return found


@pytest.mark.long
def test_dominated_novelty_is_the_mean_distance_to_the_nearest_fitter_elites():
    pool = replace(batch(3), fitness=jnp.arange(40.0)[::-1])
    position = np.arange(40)
    found = search.dominated_novelty(
        search.places(pool.measures, AXES), pool.occupied, jnp.asarray(position), 3
    )
    np.testing.assert_allclose(found, by_rule(pool, position, 3), rtol=1e-5)
