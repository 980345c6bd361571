"""Filaments along random walks."""

import numpy as np
import pytest

from microcosmos import bodies
from microcosmos.bodies.refine import subdivided

pytestmark = pytest.mark.fast


def test_nodes_are_evenly_spaced_and_joints_turn_as_they_were_drawn():
    body = bodies.walk(5000, 0.4, 0.3, 1)
    steps = np.diff(body.positions, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T), 0.4)
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    turns = (np.diff(angle) + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(turns, body.rest_angle, atol=1e-9)
    assert abs(body.rest_angle.std() - 0.3) < 0.01
    assert abs(body.rest_angle.mean()) < 0.02


def test_the_mean_square_distance_of_ends_is_that_of_a_freely_rotating_chain():
    # Flory: <R²> = n l² [(1 + c)/(1 − c) − 2 c (1 − cⁿ)/(n (1 − c)²)], c = <cos turn>.
    n, c = 99, np.exp(-(0.5**2) / 2)
    ends = [bodies.walk(n + 1, 1.0, 0.5, seed).positions for seed in range(2000)]
    found = np.mean([np.sum((p[-1] - p[0]) ** 2) for p in ends])
    expected = n * ((1 + c) / (1 - c) - 2 * c * (1 - c**n) / (n * (1 - c) ** 2))
    assert abs(found / expected - 1) < 0.06


def test_it_may_cross_itself_where_other_bodies_may_not():
    body = bodies.walk(300, 0.4, 1.0, 0)
    assert body.crossing
    assert bodies.together([body, body]).crossing
    assert len(subdivided(body).body.positions) == 599
    with pytest.raises(ValueError, match="cells apart"):
        bodies.polyline([(0, 0), (4, 0), (2, 0.01)], 0.5)


def test_another_seed_is_another_walk_and_no_deviation_is_straight():
    assert (
        bodies.walk(9, 1.0, 0.3, 0).rest_angle != bodies.walk(9, 1.0, 0.3, 1).rest_angle
    ).all()
    assert np.ptp(bodies.walk(9, 1.0, 0.0, 0).positions[:, 1]) == 0
    with pytest.raises(ValueError, match="deviation"):
        bodies.walk(9, 1.0, np.nan, 0)
