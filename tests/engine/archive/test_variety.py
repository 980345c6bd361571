"""The motion distance against closed forms and against a search over shifts and rotations."""

from itertools import product

import numpy as np
import pytest
from pose_streams import stream

from microcosmos.archive import variety
from microcosmos.archive.poses import FRAMES

NOISE = 3e-4
"""Distance of equal motions: poses are in 16 bits, sums in single precision."""


def wave(seed, nodes=25, frames=32):
    """A random motion of a chain of length 24 that repeats after `frames`: (64, node, 2)."""
    rng = np.random.default_rng(seed)
    time = 2 * np.pi * np.arange(FRAMES)[:, None, None] / frames
    along = np.linspace(0, 1, nodes - 1)[None, :, None]
    bend, phase, waves = rng.normal(size=(3, 1, 1, 4))
    angle = np.sum(bend * np.sin((1 + np.arange(4)) * time + 6 * waves * along + 6 * phase), 2)
    steps = 24 / (nodes - 1) * np.stack([np.cos(angle), np.sin(angle)], 2)
    swum = 0.1 * np.arange(FRAMES)[:, None, None]
    return swum + np.pad(np.cumsum(steps, 1), ((0, 0), (1, 0), (0, 0)))


def turned(positions, angle):
    c, s = np.cos(angle), np.sin(angle)
    return positions @ np.array([[c, s], [-s, c]])


def distance(one, other):
    return variety.variety([one, other]).motion_distance


def still(positions):
    return np.repeat(positions[None], FRAMES, 0)


def rod(nodes=257):
    x = np.linspace(-12, 12, nodes)
    return stream(still(np.stack([x, 0 * x], 1)), 24)


def circle(nodes=257):
    angle = np.linspace(0, 2 * np.pi, nodes)
    return stream(still(24 / (2 * np.pi) * np.stack([np.cos(angle), np.sin(angle)], 1)), 24)


@pytest.mark.parametrize(
    "copy",
    [
        lambda x: np.roll(x, 5, 0),
        lambda x: turned(x, 2.0) + np.array([7.0, -3.0]),
        lambda x: x * [1.0, -1.0],
        lambda x: x[:, ::-1],
        lambda x: turned(np.roll(x, 11, 0)[:, ::-1] * [1.0, -1.0], -1.0),
    ],
    ids=["shifted", "turned", "mirrored", "exchanged", "all"],
)
def test_a_copy_is_at_no_distance(copy):
    # The chain does not swim: a roll would move its end to its start.
    motion = wave(1) - wave(1).mean(1, keepdims=True)
    assert distance(stream(motion, 24), stream(copy(motion), 24)) < NOISE


def test_number_of_nodes_matters_little():
    coarse, fine = (stream(wave(1, nodes), 24) for nodes in (49, 97))
    assert distance(coarse, fine) < 0.01
    assert distance(coarse, stream(wave(2, 97), 24)) > 0.1


def test_rod_and_circle_are_at_the_distance_in_closed_form():
    # Mean squares 1/12 and 1/4π², correlation of modulus 1/4π²; 64 midpoints are near enough.
    found = variety.variety([rod(), circle()])
    np.testing.assert_allclose(
        found.motion_distance, np.sqrt(1 / 12 - 1 / (4 * np.pi**2)), rtol=1e-3
    )
    assert found.nearest_motion == pytest.approx(found.motion_distance)
    assert found.motion_alone < NOISE
    assert found.kinds == 2


def test_motion_alone_ignores_the_mean_pose():
    # Both lengthen by a tenth and back; on a circle and on a rod that is a motion of
    # 0.1 sin(t) times the pose.
    swing = (1 + 0.1 * np.sin(2 * np.pi * np.arange(FRAMES) / 32))[:, None, None]
    one, other = (stream(swing * creature.cells, 24) for creature in (rod(), circle()))
    still_distance = np.sqrt(1 / 12 - 1 / (4 * np.pi**2))
    found = variety.variety([one, other])
    np.testing.assert_allclose(found.motion_alone, 0.1 / np.sqrt(2) * still_distance, rtol=1e-3)


def test_distance_is_the_least_over_shifts_rotations_mirrors_and_ends():
    one, other = (variety.stroke(stream(wave(seed), 24)) for seed in (0, 1))
    rotations = np.exp(2j * np.pi * np.arange(200) / 200)[:, None, None]
    least = np.inf
    for mirrored, exchanged, shift in product((False, True), (False, True), range(32)):
        copy = other.conj() if mirrored else other
        copy = np.roll(copy[:, ::-1] if exchanged else copy, shift, 0)
        away = np.abs(one[None] - rotations * copy[None])
        least = min(least, np.sqrt((away**2).mean((1, 2))).min())
    found = variety.distances(np.stack([one, other]), np.ones(2, bool))
    np.testing.assert_allclose(found, [[0, least], [least, 0]], atol=1e-4)


def test_ends_of_a_tree_are_not_exchanged():
    angle = np.array([0.0, 2.0, 4.5])
    tips = np.stack([np.cos(angle), np.sin(angle)], 1) * np.array([[4.0], [8.0], [12.0]])
    nodes, edges = np.concatenate([np.zeros((1, 2)), tips]), [[0, 1], [0, 2], [0, 3]]
    assert not variety.is_chain(np.array(edges))
    assert not variety.is_chain(np.array([[0, 1], [1, 2], [2, 0]]))
    one = stream(still(nodes), 20, edges)
    other = stream(still(nodes), 20, edges[::-1])
    assert distance(one, one) < NOISE
    assert distance(one, other) > 0.1


def test_a_chain_may_exchange_its_ends_against_a_tree():
    strokes = np.stack([variety.stroke(stream(wave(seed), 24)) for seed in (0, 1)])
    strokes = np.concatenate([strokes, strokes[:, :, ::-1]])
    found = variety.distances(strokes, np.array([True, False, True, False]))
    np.testing.assert_allclose(found[0, 1], found[0, 3], atol=NOISE)
    assert found[0, 2] < NOISE < 0.05 < found[1, 3]


def test_kinds_are_counted_from_the_first():
    found = np.array([[0, 0.09, 0.18], [0.09, 0, 0.09], [0.18, 0.09, 0]])
    assert variety.kinds(found) == [0, 2]
    assert variety.kinds(found[[1, 0, 2]][:, [1, 0, 2]]) == [0]


def test_many_creatures_are_sampled_at_equal_intervals(monkeypatch):
    np.testing.assert_array_equal(variety.sample(3), [0, 1, 2])
    np.testing.assert_array_equal(variety.sample(1024), np.arange(0, 1024, 2))
    monkeypatch.setattr(variety, "MOST", 20)
    found = variety.variety([rod(5)] * 30 + [circle(9)] * 30)
    assert (found.creatures, found.compared, found.kinds) == (60, 20, 2)
    mean = distance(rod(5), circle(9)) * 10 * 10 / (20 * 19 / 2)
    np.testing.assert_allclose(found.motion_distance, mean, atol=NOISE)
    assert found.nearest_motion < NOISE


def test_one_creature_has_no_variety():
    with pytest.raises(ValueError, match="at least two creatures, got 1"):
        variety.variety([rod()])
