"""Colours of constraints: no two constraints of a colour share a member."""

import numpy as np
import pytest

from microcosmos import bodies

pytestmark = pytest.mark.fast


def random_graph(seed):
    """Pairs of distinct members; some pairs occur often."""
    random = np.random.default_rng(seed)
    members = int(random.integers(4, 30))
    pairs = random.integers(0, members, (60, 2))
    return pairs[pairs[:, 0] != pairs[:, 1]], members


def path(members):
    return np.stack([np.arange(members - 1), np.arange(1, members)], 1), members


def circle(members):
    return np.stack([np.arange(members), (np.arange(members) + 1) % members], 1), members


def random_body(seed):
    """Nodes on a jittered lattice, joined at random: branches, loops and loose parts."""
    random = np.random.default_rng(seed)
    lattice = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2)
    nodes = 3 * lattice + random.uniform(-1, 1, lattice.shape)
    pairs = [(i, j) for i in range(36) for j in range(i) if random.random() < 0.08]
    joined, pairs = np.unique(pairs, return_inverse=True)
    return bodies.graph(nodes[joined], pairs.reshape(-1, 2))


def world(*parts):
    placed = [bodies.placed(part, (30.0 * i, 0.0)) for i, part in enumerate(parts)]
    return bodies.combined(placed)


def require_colouring(colours, pairs):
    """Every pair is in one colour, and no two of a colour share a member."""
    coloured = []
    for colour in colours:
        first = np.flatnonzero(colour.sign == 1)
        second, chosen = colour.partner[first], colour.constraint[first]
        np.testing.assert_array_equal(pairs[chosen], np.stack([first, second], 1))
        np.testing.assert_array_equal(colour.partner[second], first)
        np.testing.assert_array_equal(colour.sign[second], -1)
        np.testing.assert_array_equal(colour.constraint[second], chosen)
        alone = colour.sign == 0
        np.testing.assert_array_equal(colour.partner[alone], np.flatnonzero(alone))
        assert len(np.unique(pairs[chosen])) == 2 * len(chosen) == np.sum(~alone)
        coloured.extend(chosen.tolist())
    assert sorted(coloured) == list(range(len(pairs)))


def require_colourings(body):
    require_colouring(body.edge_colours, body.edges)
    require_colouring(body.joint_colours, body.joints)


@pytest.mark.parametrize(
    ("pairs", "members"),
    [path(20), path(2), circle(20), circle(21), *map(random_graph, range(5))],
    ids=["chain", "shortest chain", "even ring", "odd ring", *map(str, range(5))],
)
def test_every_constraint_of_a_graph_has_one_colour(pairs, members):
    require_colouring(bodies.colour(pairs, np.zeros(members, int)), pairs)


@pytest.mark.parametrize("seed", range(8))
def test_every_constraint_of_a_random_body_has_one_colour(seed):
    body = random_body(seed)
    assert len(body.edges) >= len(body.positions)
    require_colourings(body)


def test_equal_creatures_have_equal_colours_and_need_no_more_of_them():
    one = random_body(3)
    many = world(*[one] * 5)
    for name in ("edge_colours", "joint_colours"):
        alone, colours = getattr(one, name), getattr(many, name)
        assert len(colours) == len(alone)
        for single, repeated in zip(alone, colours, strict=True):
            np.testing.assert_array_equal(repeated.sign, np.tile(single.sign, 5))


def test_a_chain_needs_two_colours_and_an_odd_ring_three():
    for (pairs, members), needed in ((path(33), 2), (circle(33), 3)):
        assert len(bodies.colour(pairs, np.zeros(members, int))) == needed
