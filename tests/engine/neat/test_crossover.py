"""Random draws, crossover and distance."""

from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat
from microcosmos.neat import rows

KEYS, PLACES = 4000, 60


@pytest.fixture(scope="module")
def drawn():
    """Numbers, (key, place)."""
    keys = jax.random.split(jax.random.key(0), KEYS)
    return np.asarray(jax.jit(jax.vmap(lambda k: rows.draws((PLACES,), key=k)[0]))(keys))


def test_every_interval_is_drawn_equally_often(drawn):
    bins = 64
    counts = np.histogram(drawn, bins, (0, 1))[0]
    expected = drawn.size / bins
    squares = ((counts - expected) ** 2 / expected).sum()
    assert squares == pytest.approx(bins - 1, abs=4 * (2 * (bins - 1)) ** 0.5)
    assert 0 <= drawn.min() < drawn.max() < 1


def test_places_are_uncorrelated_and_so_are_keys(drawn):
    for values in (drawn, drawn[:PLACES].T, drawn**2, np.floor(drawn * 2**20) % 2):
        between = np.corrcoef(values, rowvar=False) - np.eye(values.shape[1])
        assert np.abs(between).max() < 5.5 / len(values) ** 0.5


def test_the_rest_of_a_draw_is_uniform(drawn):
    for low, high in ((0.0, 0.25), (0.25, 0.9)):
        inside = drawn[(drawn >= low) & (drawn < high)]
        rest = np.asarray(rows.rescaled(jnp.asarray(inside), low, high))
        assert rest.mean() == pytest.approx(0.5, abs=4 * 0.29 / len(rest) ** 0.5)
        assert rest.std() == pytest.approx(12**-0.5, rel=0.01)


@pytest.fixture(scope="module")
def parents(grown):
    """Related networks, two by two."""
    networks = grown[-1][0]
    order = np.random.default_rng(1).permutation(networks.weight.shape[0])
    return networks, jax.tree.map(lambda x: x[order], networks)


def cross(parents, *, key, **options):
    first, second = parents
    keys = jax.random.split(jax.random.key(key), first.weight.shape[0])
    return jax.device_get(program(**options)(first, second, keys))


@cache
def program(**options):
    return jax.jit(jax.vmap(lambda a, b, k: neat.crossover(a, b, key=k, **options)))


def test_a_child_has_the_genes_of_the_fitter_and_values_of_either(parents, each, genes_of):
    mixed = 0
    for a, b, child in zip(*map(each, (*parents, cross(parents, key=0))), strict=True):
        (nodes_a, genes_a), (nodes_b, genes_b), (nodes, genes) = map(genes_of, (a, b, child))
        assert nodes.keys() == nodes_a.keys()
        assert genes.keys() == genes_a.keys()
        for number, (source, target, _, weight) in genes.items():
            assert (source, target) == genes_a[number][:2]
            donors = [d[number][3] for d in (genes_a, genes_b) if number in d]
            assert weight in donors
            mixed += weight != genes_a[number][3]
        for number, gene in nodes.items():
            assert gene in [d[number] for d in (nodes_a, nodes_b) if number in d]
    assert mixed > 50


@pytest.fixture
def families(parents, each, genes_of):
    """A function that gives the connections of both parents and of each child."""

    def read(key, **options):
        for family in zip(
            *map(each, (*parents, cross(parents, key=key, **options))), strict=True
        ):
            yield [genes_of(network)[1] for network in family]

    return read


def test_matching_genes_come_from_either_parent_equally_often(families):
    from_other = matching = disabled = off = 0
    for genes_a, genes_b, genes in (family for key in range(10) for family in families(key)):
        for number, gene in genes.items():
            donors = [d[number] for d in (genes_a, genes_b) if number in d]
            if donors[0][3] != donors[-1][3]:
                matching += 1
                from_other += gene[3] == donors[-1][3]
            if all(donor[2] for donor in donors):
                assert gene[2]
            else:
                disabled += 1
                off += not gene[2]
    assert from_other / matching == pytest.approx(0.5, abs=3 * 0.5 / matching**0.5)
    # Genes that are disabled in either parent are disabled three times in four.
    assert off / disabled == pytest.approx(0.75, abs=3 * 0.44 / disabled**0.5)


@pytest.mark.parametrize("small", [0, 19])
def test_distance_is_the_one_over_dictionaries(parents, each, plain_distance, small):
    coefficients = neat.Coefficients(1.5, 0.5, 0.7, small=small)
    measured = jax.jit(jax.vmap(lambda a, b: neat.distance(a, b, coefficients)))(*parents)
    assert np.ptp(measured) > 0.1
    for a, b, value in zip(*map(each, parents), measured, strict=True):
        assert value == pytest.approx(plain_distance(a, b, coefficients), rel=1e-5, abs=1e-6)


def test_tensorneats_distance_sums_over_nodes_and_connections(parents, each, genes_of):
    coefficients = neat.PRESETS["tensorneat"].coefficients
    measured = jax.jit(jax.vmap(lambda a, b: neat.distance(a, b, coefficients)))(*parents)
    for a, b, value in zip(*map(each, parents), measured, strict=True):
        (nodes_a, genes_a), (nodes_b, genes_b) = genes_of(a), genes_of(b)
        expected = 0.0
        for one, two, unlike in (
            (nodes_a, nodes_b, lambda x, y: abs(x[1] - y[1]) + (x[0] != y[0])),
            (genes_a, genes_b, lambda x, y: abs(x[3] - y[3])),
        ):
            total = 1.0 * len(one.keys() ^ two.keys())
            total += 0.4 * sum(unlike(one[n], two[n]) for n in one.keys() & two.keys())
            expected += total / max(len(one), len(two))
        assert value == pytest.approx(expected, rel=1e-4)
