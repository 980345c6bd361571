"""Insertion is a total order: what arrives when and where makes no difference."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, search

AXES = (
    search.Axis(feature=0, low=1e-4, high=1e2, bins=6, logarithmic=True),
    search.Axis(feature=1, low=0.0, high=1.0, bins=4, logarithmic=False),
)
CELLS = 24


def candidates(count, seed, generation=0, levels=4):
    """Random rows in which equal fitness and equal cells are common."""
    random = np.random.default_rng(seed)
    features = np.stack(
        [10 ** random.uniform(-5, 3, count), random.uniform(-0.2, 1.2, count)], 1
    )
    networks = genomes.empty(4, 4, (count,))
    networks.node_used[:] = True
    networks.bias[:] = random.integers(0, 3, (count, 4))
    rows = search.Elites(
        occupied=jnp.asarray(random.random(count) < 0.9),
        fitness=jnp.asarray(random.integers(0, levels, count), jnp.float32),
        features=jnp.asarray(features, jnp.float32),
        generation=jnp.full(count, generation, jnp.int32),
        slot=jnp.arange(count, dtype=jnp.int32),
        digest=jnp.zeros((count, 2), jnp.uint32),
        genotypes=jax.tree.map(jnp.asarray, networks),
    )
    return search.named(rows)


insert = jax.jit(lambda archive, rows: search.insert(archive, rows, AXES))


def nothing():
    return search.no_elites(CELLS, 2, jax.tree.map(jnp.asarray, genomes.empty(4, 4)))


def same(a, b):
    return all(
        np.array_equal(x, y)
        for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True)
    )


def by_dictionary(batches):
    """The winners by the written rule, one candidate after another."""
    best = {}
    for rows in batches:
        cells = np.asarray(search.cells_of(rows.features, AXES))
        for i in np.flatnonzero(rows.occupied):
            key = (
                -float(rows.fitness[i]),
                *map(int, rows.digest[i]),
                int(rows.generation[i]),
                int(rows.slot[i]),
            )
            best[cells[i]] = min(best.get(cells[i], key), key)
    return best


def test_the_archive_holds_what_the_rule_says():
    batches = [candidates(64, seed, generation=seed) for seed in range(6)]
    archive = nothing()
    for rows in batches:
        archive, _ = insert(archive, rows)
    expected = by_dictionary(batches)
    assert set(np.flatnonzero(archive.occupied)) == set(expected)
    for cell, key in expected.items():
        assert (-archive.fitness[cell], archive.generation[cell], archive.slot[cell]) == (
            key[0],
            key[3],
            key[4],
        )


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_arrival_makes_no_difference(seed):
    rows = candidates(64, seed)
    order = np.random.default_rng(seed).permutation(64)
    shuffled = jax.tree.map(lambda x: x[order], rows)
    together, inserted = insert(nothing(), rows)
    other, inserted_too = insert(nothing(), shuffled)
    first, _ = insert(nothing(), jax.tree.map(lambda x: x[:30], shuffled))
    apart, _ = insert(first, jax.tree.map(lambda x: x[30:], shuffled))
    assert same(together, other)
    assert same(together, apart)
    assert np.array_equal(np.asarray(inserted.entered)[order], inserted_too.entered)


def test_the_same_creature_again_does_not_enter():
    rows = candidates(64, 7)
    archive, _ = insert(nothing(), rows)
    again, inserted = insert(archive, rows)
    assert not inserted.entered.any()
    assert same(archive, again)


def test_what_diverged_never_touches_the_archive():
    rows = candidates(16, 8)
    broken = search.Elites(
        **{
            **vars(rows),
            "occupied": jnp.zeros(16, bool),
            "fitness": jnp.full(16, jnp.nan),
            "features": jnp.full((16, 2), jnp.nan),
        }
    )
    archive, _ = insert(nothing(), rows)
    after, inserted = insert(archive, broken)
    assert same(archive, after)
    assert not inserted.entered.any()


def test_bins_are_half_open_and_their_ends_are_counted():
    place = AXES[1].bin(jnp.array([-1.0, 0.0, 0.2499, 0.25, 0.999, 1.0, 7.0]))
    assert place.tolist() == [0, 0, 0, 1, 3, 3, 3]
    place = AXES[0].bin(jnp.array([0.0, 1e-4, 1.01e-3, 1.0, 99.0, 1e2, 1e9]))
    assert place.tolist() == [0, 0, 1, 4, 5, 5, 5]


def test_cells_are_numbered_with_the_last_descriptor_fastest():
    features = jnp.array([[1.01e-3, 0.6]])
    assert search.cells_of(features, AXES).tolist() == [1 * 4 + 2]


def test_a_digest_depends_on_every_gene_and_on_its_place():
    networks = jax.tree.map(jnp.asarray, genomes.empty(4, 4, (1,)))
    base = search.digest(networks)
    digests = [tuple(base[0].tolist())]
    for name in ("node_id", "activation", "bias", "innovation", "source", "target", "weight"):
        for row in range(4):
            changed = getattr(networks, name).at[0, row].set(1)
            other = genomes.CPPN(**{**vars(networks), name: changed})
            digests.append(tuple(search.digest(other)[0].tolist()))
    assert len(set(digests)) == len(digests)
    negative = genomes.CPPN(**{**vars(networks), "bias": -networks.bias})
    assert np.array_equal(search.digest(negative), base)
