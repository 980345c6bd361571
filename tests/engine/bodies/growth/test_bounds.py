"""Every plan grows into a body within its capacity, whatever mutations made of it."""

import body_plans
import numpy as np
import pytest
from body_plans import CAPACITY, plan_of

from microcosmos.bodies import growth
from microcosmos.bodies.growth import sprouting


def test_bodies_stay_within_their_capacity(population):
    _, grown, bones, *_ = population
    nodes = grown.present.sum(1)
    assert nodes.min() == 1 + growth.LEAST_ROOT
    assert nodes.max() < CAPACITY.nodes  # The last row stays empty.
    assert np.array_equal(grown.present, np.arange(CAPACITY.nodes)[None] < nodes[:, None])
    rings = (grown.ring_first >= 0).sum(1)
    assert np.array_equal(bones.edge_present.sum(1), nodes - 1 + rings)
    assert np.array_equal(bones.bends.sum(1), nodes - 2 + 2 * rings)
    longest = (grown.distance * _pairs(grown)).max((1, 2))
    assert longest.max() * CAPACITY.spacing <= CAPACITY.length
    ends = np.where(bones.edge_present[:, :, None], bones.edges, CAPACITY.nodes - 1)
    degree = np.stack([np.bincount(one.ravel(), minlength=CAPACITY.nodes) for one in ends])
    degree[:, -1] = 0
    assert np.array_equal(degree, np.where(grown.present, grown.degree, 0))
    assert degree.max() <= sprouting.MOST_EDGES
    assert rings.max() > 1
    assert grown.ungrown.max() > 1


def test_nodes_keep_the_clearance_that_growth_grants(population):
    _, grown, *_ = population
    pairs = _pairs(grown) & ~np.eye(CAPACITY.nodes, dtype=bool)
    position = grown.positions.astype(float)
    gap = np.linalg.norm(position[:, :, None] - position[:, None], axis=-1)
    along = np.minimum(sprouting.CLEARANCE, sprouting.FOLDED * grown.distance)
    assert (gap - CAPACITY.spacing * along)[pairs].min() > -1e-5


def test_distances_are_the_shortest_ways_along_the_edges(population):
    _, grown, bones, *_ = population
    for index in range(100):
        node = grown.present[index]
        way = np.full((len(node), len(node)), np.inf)
        np.fill_diagonal(way, 0)
        first, second = bones.edges[index][bones.edge_present[index]].T
        way[first, second] = way[second, first] = 1
        for middle in np.flatnonzero(node):
            way = np.minimum(way, way[:, middle, None] + way[None, middle])
        assert np.array_equal(grown.distance[index][node][:, node], way[node][:, node])


@pytest.mark.parametrize(
    ("root", "nodes"),
    [
        ({"nodes": 1, "closed": True}, 2),
        ({"nodes": 4, "closed": True}, 5),
        ({"nodes": 5, "closed": True}, 6),
        ({"nodes": 40}, 9),
        ({"nodes": 40, "curl": -6.3}, 9),
        ({"nodes": 16, "closed": True}, 9),
        ({"nodes": 7, "curl": 6.3}, 8),
        ({"nodes": 2, "curl": 6.3}, 3),
    ],
)
@pytest.mark.parametrize("spacing", [0.7, 1.0, 2.0])
def test_the_root_always_has_room(root, nodes, spacing):
    """Of at most 9 nodes, with 16 steps or more along a body at most."""
    capacity = growth.Capacity(10, 1, 1, 1, length=8 * spacing, spacing=spacing)
    grown, bones = body_plans.in_numpy(plan_of(root, rows=1), capacity)
    assert grown.present.sum() == nodes
    assert grown.ungrown == 0
    v = np.diff(grown.positions[bones.edges[bones.edge_present]], axis=1)
    np.testing.assert_allclose(np.linalg.norm(v, axis=-1), spacing, rtol=1e-5)


def test_a_root_is_cut_to_the_largest_length():
    capacity = growth.Capacity(20, 1, 1, 1, length=4.0, spacing=0.8)
    assert growth.grow(plan_of({"nodes": 12}, rows=1), capacity).present.sum() == 6
    ring = plan_of({"nodes": 9, "closed": True}, rows=1)
    assert (growth.grow(ring, capacity).ring_first >= 0).sum() == 1
    long = plan_of({"nodes": 11, "closed": True}, rows=1)
    assert (growth.grow(long, capacity).ring_first >= 0).sum() == 0


def _pairs(grown):
    return grown.present[:, :, None] & grown.present[:, None]
