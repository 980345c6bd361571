"""Populations under selection: species, children, and what networks stay."""

from dataclasses import replace
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat
from microcosmos.neat import generation as breeding
from microcosmos.neat import species as division

INPUTS, OUTPUTS = 3, 2


@pytest.fixture(scope="module", params=["grown", "shrunk"])
def history(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module", params=["grown", "shrunk", "mutated"])
def networks_of(request):
    """The networks and counters of every generation, selected or only mutated."""
    history = request.getfixturevalue(request.param)
    return [(networks, counters) for networks, _, _, counters, *_ in history]


@pytest.fixture(scope="module")
def rules(history, settings, shrinking, grown):
    return settings if history is grown else shrinking


def test_no_network_ever_holds_a_cycle_or_joins_two_nodes_twice(networks_of, each):
    for networks, _ in networks_of:
        for network in each(networks):
            n, c = network.node_used.sum(), network.connection_used.sum()
            joined = np.zeros((n, n), int)
            np.add.at(joined, (network.target[:c], network.source[:c]), 1)
            assert joined.max() <= 1
            assert not joined[:INPUTS].any()
            assert not np.linalg.matrix_power(joined, n).any()


def test_rows_stay_canonical(networks_of, each):
    for networks, counters in networks_of:
        for network in each(networks):
            for used, number, end in (
                (network.node_used, network.node_id, counters.node),
                (network.connection_used, network.innovation, counters.innovation),
            ):
                many = used.sum()
                assert used[:many].all()
                assert (np.diff(number[:many]) > 0).all()
                assert (number[:many] < end).all()
            n, c = network.node_used.sum(), network.connection_used.sum()
            assert (network.node_id[: INPUTS + OUTPUTS] == range(INPUTS + OUTPUTS)).all()
            assert max(network.source[:c].max(initial=0), network.target[:c].max(initial=0)) < n
            assert not network.weight[c:].any()
            assert not network.enabled[c:].any()


def test_a_number_means_the_same_ends_for_ever(networks_of, each, genes_of):
    ends = {}
    for networks, _ in networks_of:
        for network in each(networks):
            for number, gene in genes_of(network)[1].items():
                assert ends.setdefault(number, gene[:2]) == gene[:2]


def test_bounds_hold(shrunk, shrinking):
    assert np.abs(shrunk[-1][0].weight).max() <= shrinking.rates.bound


@pytest.mark.parametrize(
    "history", ["grown"], indirect=True
)  # The plain distance is the paper's.
def test_every_network_is_in_the_first_species_that_it_fits(
    history, each, rules, plain_distance
):
    for before, (networks, _, species, *_) in list(pairwise(history))[::4]:
        bred = len(np.unique(before[2].of[before[4][:, 0]]))
        tried = bred + species.next_number - before[2].next_number
        own = [
            r
            for r, alive in zip(each(species.representatives), species.alive, strict=True)
            if alive
        ]
        assert (species.members[: len(own)] > 0).all()
        for row, network in zip(species.of, each(networks), strict=True):
            far = [plain_distance(network, one, rules.coefficients) for one in own]
            fits = [place for place, d in enumerate(far) if d < float(species.threshold)]
            if fits:
                assert row == fits[0]
            else:
                assert far[row] == pytest.approx(min(far), rel=1e-5)
                assert tried == rules.max_species


def test_members_are_counted_and_rows_that_live_come_first(history):
    for _, _, species, *_ in history:
        rows = len(species.alive)
        np.testing.assert_array_equal(np.bincount(species.of, minlength=rows), species.members)
        np.testing.assert_array_equal(species.alive, species.members > 0)
        living = species.number[species.alive]
        assert species.alive[: len(living)].all()
        assert (np.diff(living) > 0).all()
        assert (living < species.next_number).all()


def test_only_networks_with_finite_fitness_are_parents_the_fitter_first(history):
    for _, fitness, _, _, parents, _ in history[:-1]:
        assert np.isfinite(fitness[parents[:, 0]]).all()
        second = parents[:, 1][parents[:, 1] >= 0]
        assert np.isfinite(fitness[second]).all()
        first, second = parents[parents[:, 1] >= 0].T
        assert (fitness[first] >= fitness[second]).all()


def test_parents_are_among_the_best_of_their_species(history, rules):
    for _, fitness, species, _, parents, codes in history[:-1]:
        for place in np.unique(parents[codes != 0, 0]):
            own = fitness[species.of == species.of[place]]
            own = np.where(np.isfinite(own), own, -np.inf)
            better = (own > fitness[place]).sum()
            assert better < np.ceil(rules.survival * len(own) - 1e-6)


def test_champions_of_large_species_that_breed_survive_unchanged(history, rules):
    copies = 0
    for before, after in pairwise(history):
        networks, fitness, species, _, parents, codes = before
        children = after[0]
        for row in np.unique(species.of[parents[:, 0]]):
            own = np.flatnonzero((species.of == row) & np.isfinite(fitness))
            if species.members[row] < rules.elite_size:
                continue
            champion = int(own[np.argmax(fitness[own])])
            slot = np.flatnonzero((codes == 0) & (parents[:, 0] == champion))
            assert len(slot) == 1
            copies += 1
            copy = genomes.take(children, int(slot[0]))
            jax.tree.map(np.testing.assert_array_equal, copy, genomes.take(networks, champion))
    assert copies > 10


def test_the_same_keys_give_the_same_bits(evolve, settings, grown):
    jax.tree.map(np.testing.assert_array_equal, evolve(settings, 14)[-1], grown[-1])


@pytest.mark.parametrize("broken", [np.nan, -np.inf])
def test_a_population_without_any_finite_fitness_stays(grown, advance, settings, broken):
    networks, _, species, counters, _, _ = jax.tree.map(jnp.asarray, grown[-1])
    fitness = jnp.full(networks.weight.shape[0], broken, jnp.float32)
    children, divided, after, parents, codes = advance(settings)(
        networks, fitness, species, counters, jax.random.key(0), jnp.asarray(14)
    )
    jax.tree.map(np.testing.assert_array_equal, children, networks)
    assert (np.asarray(codes) == 0).all()
    assert (np.asarray(parents[:, 1]) == -1).all()
    assert divided.members.sum() == len(fitness)
    assert after.innovation == counters.innovation


@pytest.mark.long
def test_shared_fitness_allots_children_unless_a_species_does_not_improve(settings):
    species = _two_species(settings)
    fitness = jnp.array([2.0, 4.0, 1.0, 1.0, 0.5, 1.5])
    now = breeding.ranking(species, fitness)
    share = breeding.shares(species.alive, fitness, species, now, settings)
    np.testing.assert_allclose(share, [0.75, 0.25, 0.0], rtol=1e-6)
    for generation, expected in ((3, [True, True]), (4, [True, False])):
        now = breeding.ranking(species, fitness)
        noted = breeding.recorded(species, now, jnp.asarray(0))
        able, _ = breeding.allowed(noted, now, settings, jnp.asarray(generation))
        np.testing.assert_array_equal(able[:2], expected)


def test_children_sum_to_the_population_and_are_near_their_share():
    random = np.random.default_rng(0)
    for _ in range(200):
        able = random.random(9) < 0.7
        able[random.integers(9)] = True
        share = np.where(able, random.random(9) ** 4, 0.0).astype(np.float32)
        total, minimum = int(random.integers(9, 10_000)), int(random.integers(0, 2))
        sizes = breeding.allot(jnp.asarray(share), jnp.asarray(able), total, minimum)
        sizes = np.asarray(sizes)
        assert sizes.sum() == total
        assert (sizes[~able] == 0).all()
        assert (sizes[able] >= minimum).all()
        exact = minimum * able + share / share.sum() * (total - minimum * able.sum())
        assert np.abs(sizes - exact).max() < 1.01


def _two_species(settings):
    keys = jax.random.split(jax.random.key(0), 6)
    networks = jax.vmap(lambda k: neat.minimal(k, INPUTS, OUTPUTS, 8, 12))(keys)
    empty = division.no_species(networks, replace(settings, max_species=3))
    return replace(
        empty,
        alive=jnp.array([True, True, False]),
        number=jnp.array([0, 1, -1]),
        members=jnp.array([2, 4, 0]),
        of=jnp.array([0, 0, 1, 1, 1, 1]),
    )
