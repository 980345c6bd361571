"""Growth by examples that can be checked by hand."""

import numpy as np
import pytest
from body_plans import CAPACITY, in_numpy, plan_of

from microcosmos.bodies import growth

RIGHT = np.float32(np.pi / 2)
ROOT = {"nodes": 4}
"""Five nodes along x, from 0 to 4."""


@pytest.fixture
def nodes_of():
    """A function that gives the positions of the nodes that grow from segments."""

    def find(*segments, capacity=CAPACITY, ungrown=0):
        grown, _ = in_numpy(plan_of(*segments), capacity)
        assert grown.ungrown == ungrown
        return grown.positions[grown.present]

    return find


def close(found, expected):
    np.testing.assert_allclose(found, expected, atol=2e-6)


def line(start, way, count):
    return np.array(start) + np.arange(1, count + 1)[:, None] * np.array(way)


def test_a_root_grows_along_x_or_bends(nodes_of):
    close(nodes_of({"nodes": 3}), [[0, 0], [1, 0], [2, 0], [3, 0]])
    bent = nodes_of({"nodes": 3, "curl": 2 * np.pi / 3})
    close(bent, [[0, 0], [1, 0], [1.5, np.sqrt(0.75)], [1, np.sqrt(3)]])


def test_a_limb_stands_at_its_place(nodes_of):
    limb = {"nodes": 3, "angle": RIGHT}
    for place, x in ((0.0, 0), (0.25, 1), (0.45, 2), (1.0, 4)):
        close(nodes_of(ROOT, limb | {"place": place})[5:], line((x, 0), (0, 1), 3))


def test_a_mirrored_limb_has_its_image_across_the_parent(nodes_of):
    limb = {"nodes": 4, "place": 0.5, "angle": 1.1, "curl": 1.3, "mirrored": True}
    branch = {"parent": 1, "nodes": 3, "place": 1.0, "angle": 0.7, "curl": -0.4}
    one, other = (slice(5, 9), slice(9, 13)), (slice(13, 16), slice(16, 19))
    found = nodes_of(ROOT, limb, branch)
    for left, right in (one, other):
        close(found[left] * [1, -1], found[right])
    assert found[5:9, 1].min() > 0


def test_copies_are_spread_along_the_parent_up_to_the_place(nodes_of):
    root = {"nodes": 9}
    limb = {"nodes": 2, "angle": RIGHT, "copies": 3}
    for place, spots in ((1.0, (3, 6, 9)), (2 / 3, (2, 4, 6))):
        expected = np.concatenate([line((x, 0), (0, 1), 2) for x in spots])
        close(nodes_of(root, limb | {"place": place})[10:], expected)


def test_copies_are_spread_evenly_around_a_ring_and_point_outwards(nodes_of):
    root = {"nodes": 11, "closed": True}
    found = nodes_of(root, {"nodes": 3, "copies": 4})
    middle = found[:12].mean(0)
    arms = (found[12:] - middle).reshape(4, 3, 2)
    angle = np.arctan2(arms[..., 1], arms[..., 0])
    close(angle - angle[:, :1], np.zeros((4, 3)))
    apart = np.diff(np.unwrap(angle[:, 0]))
    np.testing.assert_allclose(apart, np.full(3, apart[0]), atol=1e-5)
    np.testing.assert_allclose(np.abs(apart[0]), np.pi / 2, atol=1e-5)
    radius = 0.5 / np.sin(np.pi / 12)
    close(np.linalg.norm(arms, axis=-1), np.tile(radius + np.arange(1, 4), (4, 1)))


@pytest.mark.parametrize("copies", [2, 3, 5])
def test_copies_at_the_base_of_the_root_make_a_star(nodes_of, copies):
    arms = nodes_of(ROOT, {"nodes": 4, "copies": copies})[1:].reshape(-1, 4, 2)
    angle = 2 * np.pi * np.arange(copies + 1) / (copies + 1)
    way = np.stack([np.cos(angle), np.sin(angle)], 1)
    close(arms, np.arange(1, 5)[None, :, None] * way[:, None])


def test_copies_of_a_parent_have_each_their_limbs(nodes_of):
    limb = {"nodes": 4, "place": 0.5, "angle": RIGHT, "mirrored": True}
    toe = {"parent": 1, "nodes": 3, "place": 0.75, "angle": RIGHT}
    found = nodes_of({"nodes": 8}, limb, toe)
    close(found[17:20], line((4, 3), (-1, 0), 3))
    close(found[20:], line((4, -3), (-1, 0), 3))


SILENT = {
    "too near": ({"nodes": 5, "place": 1.0, "angle": np.pi}, CAPACITY),
    "too many nodes": (
        {"nodes": 5, "place": 1.0},
        growth.Capacity(10, 8, 3, 12, length=40.0),
    ),
    "too long": ({"nodes": 5, "place": 1.0}, growth.Capacity(49, 8, 3, 12, length=8.0)),
    "too many copies": (
        {"nodes": 2, "place": 1.0, "angle": RIGHT, "copies": 2, "mirrored": True},
        growth.Capacity(49, 8, 3, 3, length=40.0),
    ),
    "no room for a ring": (
        {"nodes": 7, "place": 1.0, "closed": True},
        growth.Capacity(49, 8, 0, 12, length=40.0),
    ),
    "too short for a ring": ({"nodes": 4, "place": 1.0, "closed": True}, CAPACITY),
    "too many edges": (
        {"nodes": 7, "copies": 5, "closed": True},
        growth.Capacity(99, 8, 8, 12, length=40.0),
    ),
}


@pytest.mark.parametrize("reason", SILENT)
def test_a_segment_without_room_is_silent_as_are_its_descendants(nodes_of, reason):
    segment, capacity = SILENT[reason]
    alone = nodes_of(ROOT, capacity=capacity)
    child, grandchild = {"parent": 1, "nodes": 2}, {"parent": 2, "nodes": 2, "place": 1.0}
    close(nodes_of(ROOT, segment, child, grandchild, capacity=capacity, ungrown=3), alone)
    room = {"nodes": 2, "place": 0.5, "angle": RIGHT}
    more = nodes_of(ROOT, segment, child, room, capacity=capacity, ungrown=2)
    close(more[5:], line((2, 0), (0, 1), 2))


def test_copies_around_the_base_of_the_root_have_no_mirror_images(nodes_of):
    star = nodes_of({"nodes": 4}, {"nodes": 4, "copies": 3})
    again = nodes_of({"nodes": 4}, {"nodes": 4, "copies": 3, "mirrored": True})
    close(again, star)


def test_copies_at_the_base_of_a_limb_are_one(nodes_of):
    limb = {"nodes": 8, "place": 0.5, "angle": RIGHT}
    toe = {"parent": 1, "nodes": 3, "angle": np.pi}
    close(nodes_of({"nodes": 8}, limb, toe | {"copies": 3}), nodes_of({"nodes": 8}, limb, toe))


def test_nodes_know_their_place_in_the_body():
    limb = {"nodes": 4, "place": 0.1, "angle": 2.0, "mirrored": True, "stiffness": 0.25}
    fin = {"nodes": 2, "place": 1.0, "angle": RIGHT, "copies": 3}
    grown, bones = in_numpy(plan_of({"nodes": 9, "stiffness": 0.5}, limb, fin))
    assert grown.present.sum() == 10 + 8 + 6
    close(grown.side[:18], [0] * 10 + [1] * 4 + [-1] * 4)
    close(grown.hand[:18], [1] * 14 + [-1] * 4)
    close(grown.limb[18:24], [-1, -1, 0, 0, 1, 1])
    close(grown.along[10:14], [-0.5, 0, 0.5, 1])
    close(grown.along[:10], np.linspace(-1, 1, 10))
    close(grown.distance[0, 10:14], 1 + np.arange(1, 5))
    close(bones.stiffness[bones.driver == 11], 0.25)
    close(bones.stiffness[bones.driver == 5], 0.5)
    close(bones.hand[bones.driver == 15], -1)
