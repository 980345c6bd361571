"""Bodies as graphs, and the colouring of their constraints."""

import numpy as np
import pytest

from microcosmos import bodies


def random_graph(seed):
    """Pairs of distinct members, some of them met often."""
    random = np.random.default_rng(seed)
    members = int(random.integers(4, 30))
    pairs = random.integers(0, members, (60, 2))
    return pairs[pairs[:, 0] != pairs[:, 1]], members


def path(members):
    return np.stack([np.arange(members - 1), np.arange(1, members)], 1), members


def circle(members):
    return np.stack([np.arange(members), (np.arange(members) + 1) % members], 1), members


GRAPHS = {
    "chain": path(20),
    "shortest chain": path(2),
    "even ring": circle(20),
    "odd ring": circle(21),
    **{f"random {seed}": random_graph(seed) for seed in range(5)},
}


@pytest.mark.parametrize("name", GRAPHS)
def test_constraints_of_a_colour_share_no_member(name):
    pairs, members = GRAPHS[name]
    for colour in bodies.colour(pairs, members):
        touched = np.flatnonzero(colour.sign)
        constraint, count = np.unique(colour.constraint[touched], return_counts=True)
        assert np.all(count == 2)
        met = pairs[constraint].reshape(-1)
        assert len(met) == len(set(met.tolist()))


@pytest.mark.parametrize("name", GRAPHS)
def test_every_constraint_has_exactly_one_colour(name):
    pairs, members = GRAPHS[name]
    covered = [
        constraint
        for colour in bodies.colour(pairs, members)
        for constraint in colour.constraint[colour.sign > 0]
    ]
    assert sorted(covered) == list(range(len(pairs)))


@pytest.mark.parametrize("name", GRAPHS)
def test_both_members_of_a_pair_know_each_other(name):
    pairs, members = GRAPHS[name]
    for colour in bodies.colour(pairs, members):
        first, second = np.flatnonzero(colour.sign == 1), colour.partner[colour.sign == 1]
        np.testing.assert_array_equal(
            pairs[colour.constraint[first]], np.stack([first, second], 1)
        )
        np.testing.assert_array_equal(colour.partner[second], first)
        np.testing.assert_array_equal(colour.sign[second], -1)
        alone = colour.sign == 0
        np.testing.assert_array_equal(colour.partner[alone], np.flatnonzero(alone))


def test_a_chain_needs_two_colours():
    assert len(bodies.colour(*path(33))) == 2


def test_an_odd_ring_needs_three_colours():
    assert len(bodies.colour(*circle(33))) == 3


@pytest.mark.parametrize("spacing", [0.5, 1.0, 2.0])
def test_a_chain_at_rest_satisfies_its_own_constraints(spacing):
    body = bodies.chain(9, spacing, stretch=1.0, shear=1.0, bend=0.5)
    v = np.diff(body.positions, axis=0)
    np.testing.assert_allclose(np.hypot(v[:, 0], v[:, 1]), body.rest_length)
    np.testing.assert_allclose(np.diff(np.arctan2(v[:, 1], v[:, 0])), body.rest_angle)
    np.testing.assert_array_equal(
        body.edges[body.joints[:, 0], 1], body.edges[body.joints[:, 1], 0]
    )
    assert (body.arc[0], body.arc[-1]) == (0, 1)
