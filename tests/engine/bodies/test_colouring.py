"""Colours of bodies with branches and loops, and of many bodies at once."""

import numpy as np
import pytest

from microcosmos import bodies


def random_body(seed):
    """Nodes on a jittered lattice, joined at random: branches, loops and loose parts."""
    random = np.random.default_rng(seed)
    lattice = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2)
    nodes = 3 * lattice + random.uniform(-1, 1, lattice.shape)
    pairs = [(i, j) for i in range(36) for j in range(i) if random.random() < 0.08]
    return bodies.graph(nodes, pairs)


def cover(colours, pairs):
    """Every pair is in one colour, and no two of a colour share a member."""
    seen = []
    for colour in colours:
        first = np.flatnonzero(colour.sign == 1)
        chosen = colour.constraint[first]
        np.testing.assert_array_equal(pairs[chosen, 0], first)
        np.testing.assert_array_equal(pairs[chosen, 1], colour.partner[first])
        assert len(np.unique(pairs[chosen])) == 2 * len(chosen)
        assert np.count_nonzero(colour.sign) == 2 * len(chosen)
        seen.extend(chosen.tolist())
    assert sorted(seen) == list(range(len(pairs)))


@pytest.mark.fast
@pytest.mark.parametrize("seed", range(8))
def test_colours_cover_a_random_graph_without_sharing_members(seed):
    body = random_body(seed)
    assert len(body.edges) >= len(body.positions)
    cover(body.edge_colours, body.edges)
    cover(body.joint_colours, body.joints)


@pytest.mark.fast
def test_colours_cover_a_world_of_different_creatures():
    parts = [random_body(0), bodies.ring(9, 1.0), random_body(0), bodies.chain(2, 1.0)]
    body = bodies.together(
        [bodies.placed(part, (30.0 * i, 0.0)) for i, part in enumerate(parts)]
    )
    cover(body.edge_colours, body.edges)
    cover(body.joint_colours, body.joints)


@pytest.mark.fast
def test_creatures_alike_are_coloured_alike_and_need_no_more_colours():
    one = random_body(3)
    many = bodies.together([bodies.placed(one, (30.0 * i, 9.0)) for i in range(5)])
    for alone, colours in (
        (one.edge_colours, many.edge_colours),
        (one.joint_colours, many.joint_colours),
    ):
        assert len(colours) == len(alone)
        for single, repeated in zip(alone, colours, strict=True):
            np.testing.assert_array_equal(repeated.sign, np.tile(single.sign, 5))


@pytest.mark.fast
def test_a_ring_with_branches_needs_few_colours():
    body = bodies.svg(
        "M 6 0 A 6 6 0 0 1 -6 0 A 6 6 0 0 1 6 0 Z M 0 6 L 0 12 M 0 -6 L 0 -12", 1.0
    )
    assert np.bincount(body.joint_nodes).max() == 3
    assert len(body.edge_colours) <= 5
    assert len(body.joint_colours) <= 5
