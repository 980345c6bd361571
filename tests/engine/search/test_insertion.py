"""Insertion is a total order: what arrives when and where makes no difference."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from elite_rows import AXES, awkward, candidates, same

from microcosmos import genomes, search
from microcosmos.device import array

AROUND = np.random.default_rng(1).random((24, 2)).astype(np.float32)
CELLS = {"grid": search.Grid(AXES), "cvt": search.voronoi(AXES, AROUND)}
COUNT = 24

insert = jax.jit(search.insert)
digest = jax.jit(search.digest)
cells_of = jax.jit(lambda cells, measures: cells.of(measures))


@pytest.fixture(params=["grid", "cvt"])
def cells(request):
    return CELLS[request.param]


@pytest.fixture(params=["networks", "vectors"])
def genotypes(request):
    """A function that makes `count` genotypes of either kind, few of them different."""

    def networks(random, count):
        found = genomes.empty(4, 4, (count,))
        found.node_used[:] = True
        found.bias[:] = random.integers(0, 3, (count, 4))
        return jax.tree.map(array, found)

    def vectors(random, count):
        return genomes.Vector(array(random.integers(-1, 2, (count, 3)), np.float32))

    return networks if request.param == "networks" else vectors


def nothing(genotypes):
    one = jax.tree.map(lambda x: np.asarray(x)[0], genotypes(np.random.default_rng(0), 1))
    return search.no_elites(COUNT, 2, one)


def all_of(batches, cells, archive):
    for rows in batches:
        archive, _ = insert(archive, rows, cells)
    return archive


def by_dictionary(batches, cells):
    """The winners by the written rule, one candidate after another."""
    best = {}
    for rows in batches:
        digests = np.asarray(digest(rows.genotypes))
        place = np.asarray(cells_of(cells, rows.measures))
        rows = jax.device_get(rows)
        fitness = np.asarray(rows.fitness, float)
        sound = np.isfinite(rows.measures).all(1) & np.isfinite(fitness)
        for i in np.flatnonzero(np.asarray(rows.occupied) & sound):
            place_of = (int(rows.generation[i]), int(rows.slot[i]))
            key = (-fitness[i], *map(int, digests[i]), *place_of)
            best[place[i]] = min(best.get(place[i], key), key)
    return best


@pytest.mark.parametrize("kind", [candidates, awkward])
def test_the_archive_holds_what_the_rule_says(cells, genotypes, kind):
    batches = [kind(genotypes, 64, seed, generation=seed // 2) for seed in range(12)]
    archive = jax.device_get(all_of(batches, cells, nothing(genotypes)))
    expected = by_dictionary(batches, cells)
    assert set(np.flatnonzero(archive.occupied)) == set(expected)
    for cell, key in expected.items():
        place = (int(archive.generation[cell]), int(archive.slot[cell]))
        assert (-float(archive.fitness[cell]), *place) == (key[0], *key[-2:])


@pytest.mark.parametrize("kind", [candidates, awkward])
@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_arrival_makes_no_difference(cells, genotypes, kind, seed):
    rows, empty = jax.device_get(kind(genotypes, 64, seed)), nothing(genotypes)
    order = np.random.default_rng(seed).permutation(64)
    shuffled = jax.tree.map(lambda x: x[order], rows)
    together, inserted = insert(empty, rows, cells)
    other, inserted_too = insert(empty, shuffled, cells)
    parts = [jax.tree.map(lambda x, s=s: x[s], shuffled) for s in (slice(32), slice(32, 64))]
    assert same(together, other)
    assert same(together, all_of(parts, cells, empty))
    assert same(together, all_of(parts[::-1], cells, empty))
    assert np.array_equal(np.asarray(inserted.entered)[order], inserted_too.entered)


@pytest.mark.long
def test_the_same_creature_again_does_not_enter_and_donation_changes_nothing(cells, genotypes):
    rows = candidates(genotypes, 64, 7)
    archive, _ = insert(nothing(genotypes), rows, cells)
    again, inserted = insert(archive, rows, cells)
    assert not inserted.entered.any()
    assert same(archive, again)
    before = nothing(genotypes)
    donated, _ = search.insert_program(donate=True)(before, rows, cells)
    assert same(archive, donated)
    assert not before.occupied.any()


def test_one_of_equal_rows_enters(cells, genotypes):
    rows = candidates(genotypes, 1, 3)
    rows = jax.tree.map(lambda x: array(np.concatenate([x, x])), rows)
    rows = replace(rows, occupied=array(np.ones(2, bool)))
    _, inserted = insert(nothing(genotypes), rows, cells)
    assert int(inserted.entered.sum()) == 1


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", ["fitness", "first", "second"])
def test_rows_that_are_not_finite_never_enter(cells, genotypes, odd, place):
    rows = candidates(genotypes, 32, 8)
    fitness = array(np.full(32, odd if place == "fitness" else 9.0), np.float32)
    measures = np.array(rows.measures)
    if place != "fitness":
        measures[:, ("first", "second").index(place)] = odd
    sound = {"occupied": array(np.ones(32, bool)), "measures": array(measures)}
    broken = replace(rows, fitness=fitness, **sound)
    archive, _ = insert(nothing(genotypes), rows, cells)
    after, inserted = insert(archive, broken, cells)
    assert same(archive, after)
    assert not inserted.entered.any()
    assert np.all(np.asarray(inserted.cell) == COUNT)


@pytest.mark.parametrize("seed", range(3))
def test_odd_numbers_change_no_cell_but_their_own(cells, genotypes, seed):
    sober, odd = candidates(genotypes, 32, seed), awkward(genotypes, 32, seed + 50)
    archive, _ = insert(nothing(genotypes), sober, cells)
    after, inserted = insert(archive, odd, cells)
    own = np.zeros(COUNT, bool)
    own[np.asarray(inserted.cell)[np.asarray(inserted.entered)]] = True
    kept = [jax.tree.map(lambda x: np.asarray(x)[~own], rows) for rows in (archive, after)]
    assert same(*kept)


def test_a_digest_depends_on_every_gene_and_on_its_place():
    networks = jax.tree.map(array, genomes.empty(4, 4, (1,)))
    base = np.asarray(digest(networks))
    digests = [tuple(base[0].tolist())]
    for name in ("node_id", "activation", "bias", "innovation", "source", "target", "weight"):
        for row in range(4):
            changed = np.array(getattr(networks, name))
            changed[0, row] = 1
            other = replace(networks, **{name: array(changed)})
            digests.append(tuple(np.asarray(digest(other))[0].tolist()))
    assert len(set(digests)) == len(digests)
    negative = replace(networks, bias=array(-np.asarray(networks.bias)))
    assert np.array_equal(digest(negative), base)
