"""Bodies that are placed, put together, subdivided, thinned or measured."""

import numpy as np
import pytest

from microcosmos import bodies
from microcosmos.bodies import extent, reach

pytestmark = pytest.mark.fast

PARTS = [
    bodies.star(5, 4, 1.0, bend=0.5),
    bodies.ring(9, 1.0),
    bodies.chain(5, 1.0, stretch=0.3),
    bodies.tree(3, 2, 4, 1.0, 0.9),
]


def world():
    placed = [bodies.placed(part, (20.0 * i, 7.0), 0.3 * i) for i, part in enumerate(PARTS)]
    return bodies.combined(placed)


def errors(body):
    """Lengths of edges and angles of joints, less what they are at rest."""
    v = body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]
    z = v @ [1, 1j]
    turn = z[body.joints[:, 1]] / z[body.joints[:, 0]]
    return np.abs(z) - body.rest_length, np.angle(turn * np.exp(-1j * body.rest_angle))


@pytest.mark.parametrize("part", PARTS)
def test_a_placed_body_is_turned_about_its_centre(part):
    body = bodies.placed(part, (3.0, -4.0), 0.7)
    np.testing.assert_allclose(body.positions.mean(0), (3, -4), atol=1e-12)
    before = (part.positions - part.positions.mean(0)) @ [1, 1j]
    after = (body.positions - (3, -4)) @ [1, 1j]
    np.testing.assert_allclose(after, before * np.exp(0.7j), atol=1e-12)
    for error in errors(body):
        np.testing.assert_allclose(error, 0, atol=1e-12)


def test_combined_bodies_keep_their_own_edges_joints_and_stiffness():
    body = world()
    assert body.count == len(PARTS)
    np.testing.assert_array_equal(np.bincount(body.member), [len(p.positions) for p in PARTS])
    owner = body.member[body.edges[:, 0]]
    for number, part in enumerate(PARTS):
        start = np.searchsorted(body.member, number)
        first = np.searchsorted(owner, number)
        own = owner[body.joints[:, 0]] == number
        np.testing.assert_array_equal(body.edges[owner == number] - start, part.edges)
        np.testing.assert_array_equal(body.joints[own] - first, part.joints)
        np.testing.assert_array_equal(body.bend[own], part.bend)
        np.testing.assert_array_equal(body.stretch[owner == number], part.stretch)
        np.testing.assert_array_equal(body.arc[body.member == number], part.arc)
    for error in errors(body):
        np.testing.assert_allclose(error, 0, atol=1e-12)


def test_creatures_on_top_of_each_other_are_refused():
    with pytest.raises(ValueError, match="nodes 0 and 5 are 0 apart"):
        bodies.combined([PARTS[2], PARTS[2]])


def test_a_subdivided_body_has_the_same_shape_twice_as_large():
    body = world()
    fine = bodies.subdivided(body)
    for error in errors(fine.body):
        np.testing.assert_allclose(error, 0, atol=1e-12)
    np.testing.assert_allclose(fine.body.positions[fine.nodes], 2 * body.positions)
    np.testing.assert_array_equal(fine.body.member[fine.nodes], body.member)
    np.testing.assert_array_equal(fine.body.rest_length, body.rest_length[fine.edges])
    np.testing.assert_array_equal(fine.body.stretch, body.stretch[fine.edges])
    np.testing.assert_array_equal(fine.body.arc[fine.nodes], body.arc)


def test_joints_of_a_subdivided_body_are_the_original_ones_and_straight_new_ones():
    body = world()
    fine = bodies.subdivided(body)
    nodes = fine.body.joint_nodes[fine.joints]
    np.testing.assert_array_equal(nodes, fine.nodes[body.joint_nodes])
    np.testing.assert_array_equal(fine.edges[fine.body.joints[fine.joints]], body.joints)
    np.testing.assert_array_equal(fine.body.rest_angle[fine.joints], body.rest_angle)
    np.testing.assert_array_equal(fine.body.bend[fine.joints], body.bend)
    new = np.setdiff1d(np.arange(len(fine.body.joints)), fine.joints)
    assert len(new) == len(body.edges)
    np.testing.assert_array_equal(fine.body.rest_angle[new], 0)
    np.testing.assert_array_equal(fine.body.bend[new], 1)


def test_a_thinned_chain_keeps_its_ends_and_its_order_and_a_small_one_all_nodes():
    body = bodies.chain(8, 1.0)
    positions, edges = bodies.thinned(body, 8)
    np.testing.assert_array_equal(positions, body.positions)
    np.testing.assert_array_equal(edges, body.edges)
    positions, edges = bodies.thinned(bodies.chain(1001, 1.0), 100)
    assert len(positions) <= 102
    assert np.ptp(positions[:, 0]) == pytest.approx(1000)
    np.testing.assert_array_equal(edges, [(i, i + 1) for i in range(len(positions) - 1)])


def test_a_thinned_tree_keeps_every_branch():
    tree = bodies.tree(3, 2, 100, 1.0, 0.9)
    positions, edges = bodies.thinned(tree, 100)
    assert len(positions) < len(tree.positions) / 4
    for degree in (1, 3):
        whole, thin = (np.bincount(found.ravel()) for found in (tree.edges, edges))
        assert (whole == degree).sum() == (thin == degree).sum() > 0


def test_a_body_reaches_as_far_as_its_longest_way_along_edges():
    assert extent(bodies.chain(9, 1.5)) == 12
    np.testing.assert_allclose(extent(bodies.ring(12, 1.0)), 6)
    np.testing.assert_allclose(extent(bodies.star(5, 4, 1.0)), 8)
    np.testing.assert_allclose(extent(bodies.tree(3, 2, 5, 1.0, 0.9)), 20)


@pytest.mark.parametrize("counts", [(3, 30), (30, 3)])
def test_of_unconnected_filaments_the_longest_counts(counts):
    rows = [[(x, 5.0 * row) for x in range(count)] for row, count in enumerate(counts)]
    first, second = ([(i, i + 1) for i in range(count - 1)] for count in counts)
    edges = [*first, *((i + counts[0], j + counts[0]) for i, j in second)]
    both = bodies.graph(np.concatenate(rows), edges)
    assert extent(both) == 29
    assert reach(both) == pytest.approx(np.hypot(29, 5))
    assert reach(bodies.ring(12, 1.0)) == extent(bodies.ring(12, 1.0))
