"""The place of each node in its body: values by hand, and mirrored bodies."""

import numpy as np
import pytest

from microcosmos import bodies
from microcosmos.bodies.swimmers import SWIMMERS

pytestmark = pytest.mark.fast

BODIES = {
    "ring": bodies.ring(12, 1.0),
    "arc": bodies.arc(12, 1.0, 0.25),
    "star": bodies.star(5, 6, 1.0),
    "star with an arm behind": bodies.star(6, 3, 1.0),
    "tree": bodies.tree(3, 2, 4, 1.0, 0.9),
    "tree with a middle branch": bodies.tree(2, 3, 3, 1.0, 1.6),
    **{name: make().body for name, make in SWIMMERS.items()},
}


AROUND = {"tadpole": 14, "cilia": 40}
"""Nodes of the ring, which come first."""


def mirrored(body):
    """The node across the x axis from each node."""
    p = body.positions - body.positions.mean(0)
    gap = np.linalg.norm(p[:, None] * [1, -1] - p[None], axis=2)
    assert np.all(gap.min(1) < 1e-9)
    return gap.argmin(1)


def test_a_chain_is_one_limb_along_its_axis():
    found = bodies.anatomy(bodies.chain(5, 1.5))
    for name in ("position", "x"):
        np.testing.assert_allclose(getattr(found, name), [-1, -0.5, 0, 0.5, 1], atol=1e-12)
    np.testing.assert_allclose(found.distance, [0, 0.25, 0.5, 0.75, 1])
    for name in ("side", "limb", "y"):
        np.testing.assert_array_equal(getattr(found, name), np.zeros(5))


def test_a_ring_is_one_limb_around_and_two_paths_to_the_node_behind():
    found = bodies.anatomy(bodies.ring(6, 1.0))
    np.testing.assert_allclose(found.position, np.arange(6) / 3 - 1, atol=1e-12)
    np.testing.assert_allclose(found.distance, np.array([0, 1, 2, 3, 2, 1]) / 3)
    np.testing.assert_array_equal(found.side, [0, 1, 1, 0, -1, -1])
    np.testing.assert_array_equal(found.limb, np.zeros(6))
    np.testing.assert_allclose(found.x, [1, 0.5, -0.5, -1, -0.5, 0.5], atol=1e-12)
    high = np.sqrt(0.75)
    np.testing.assert_allclose(found.y, [0, high, high, 0, -high, -high], atol=1e-12)


def test_arms_of_a_star_are_numbered_from_its_right_to_its_left():
    found = bodies.anatomy(bodies.star(5, 2, 1.0))
    np.testing.assert_allclose(found.position, [-1, *[0, 1] * 5], atol=1e-12)
    np.testing.assert_allclose(found.distance, [0, *[0.5, 1] * 5])
    np.testing.assert_array_equal(found.side, [0, *np.repeat([0, 1, 1, -1, -1], 2)])
    np.testing.assert_allclose(found.limb, [0, *np.repeat([0, 0.5, 1, -1, -0.5], 2)])
    # From the tips behind at x = -2 cos 36° to that ahead at 2, and 4 sin 72° wide.
    half, middle = 2 * np.sin(0.4 * np.pi), 1 - np.cos(0.2 * np.pi)
    np.testing.assert_allclose(found.x[[0, 2]], [-middle / half, (2 - middle) / half])
    np.testing.assert_allclose(found.y[[4, 10]], [1, -1])


@pytest.mark.parametrize("name", BODIES)
def test_mirrored_nodes_have_opposite_sides_and_limbs(name):
    body = BODIES[name]
    found, across = bodies.anatomy(body), mirrored(body)
    np.testing.assert_array_equal(found.side[across], -found.side)
    np.testing.assert_allclose(found.y[across], -found.y, atol=1e-9)
    np.testing.assert_allclose(found.x[across], found.x, atol=1e-9)
    off = found.side != 0
    if name in AROUND:  # A limb that mirrors itself has one number on both sides.
        off &= np.arange(len(off)) >= AROUND[name]
    np.testing.assert_allclose(found.limb[across][off], -found.limb[off], atol=1e-9)
    if name not in ("arc", "jellyfish"):  # Their first node is off the axis.
        np.testing.assert_allclose(found.distance[across], found.distance, atol=1e-9)


@pytest.mark.parametrize("name", BODIES)
def test_all_inputs_are_within_one_and_reach_it(name):
    found = vars(bodies.anatomy(BODIES[name]))
    assert all(np.abs(one).max() <= 1 for one in found.values())
    assert found["distance"].min() == 0
    assert found["distance"].max() == 1
    assert max(np.ptp(found["x"]), np.ptp(found["y"])) == pytest.approx(2)


def test_every_creature_and_every_piece_has_its_own_anatomy():
    parts = [bodies.chain(3, 1.0), bodies.star(3, 2, 1.0)]
    apart = [bodies.placed(part, (20.0 * i, 9.0)) for i, part in enumerate(parts)]
    found = bodies.anatomy(bodies.combined(apart))
    for name, values in vars(found).items():
        alone = [getattr(bodies.anatomy(part), name) for part in parts]
        np.testing.assert_allclose(values, np.concatenate(alone), atol=1e-9)
    places = [(0, 0), (1, 0), (2, 0), (0, 5), (1, 5)]
    pieces = bodies.anatomy(bodies.graph(places, [(0, 1), (1, 2), (3, 4)]))
    np.testing.assert_allclose(pieces.distance, [0, 0.5, 1, 0, 0.5])
    np.testing.assert_array_equal(pieces.limb, [-1, -1, -1, 1, 1])
