"""Bodies of many nodes, drawn with fewer."""

import numpy as np
import pytest

from microcosmos import bodies

pytestmark = pytest.mark.fast


def test_a_small_body_stays_as_it_is():
    body = bodies.chain(8, 1.0)
    positions, edges = bodies.thinned(body, 8)
    np.testing.assert_array_equal(positions, body.positions)
    np.testing.assert_array_equal(edges, body.edges)


def test_a_thinned_chain_keeps_its_ends_and_its_order():
    positions, edges = bodies.thinned(bodies.chain(1001, 1.0), 100)
    assert len(positions) <= 102
    assert np.ptp(positions[:, 0]) == pytest.approx(1000)
    np.testing.assert_array_equal(edges, [(i, i + 1) for i in range(len(positions) - 1)])


def test_a_thinned_ring_is_still_closed():
    positions, edges = bodies.thinned(bodies.ring(1000, 1.0), 100)
    np.testing.assert_array_equal(np.bincount(edges.ravel()), np.full(len(positions), 2))
    radius = np.hypot(*(positions - positions.mean(0)).T)
    np.testing.assert_allclose(radius, 1 / (2 * np.sin(np.pi / 1000)), rtol=1e-6)


def test_a_thinned_tree_keeps_every_branch():
    tree = bodies.tree(3, 2, 100, 1.0, 0.9)
    positions, edges = bodies.thinned(tree, 100)
    assert len(positions) < len(tree.positions) / 4
    for degree in (1, 3):
        whole, thin = (np.bincount(found.ravel()) for found in (tree.edges, edges))
        assert (whole == degree).sum() == (thin == degree).sum() > 0
