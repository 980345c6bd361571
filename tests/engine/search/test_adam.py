"""Adam, against what follows from its definition."""

import jax.numpy as jnp
import numpy as np

from microcosmos.search import adam


def test_the_first_step_is_as_long_as_the_rate_whatever_the_slope(float64):
    slope = jnp.asarray([1e-3, -5.0, 200.0])
    change, _ = adam.descend(adam.begin(slope), slope, 0.04)
    np.testing.assert_allclose(change, [-0.04, 0.04, -0.04], rtol=1e-4)


def test_a_slope_that_stays_is_followed_at_the_rate(float64):
    slope, state = jnp.asarray([0.3]), adam.begin(jnp.zeros(1))
    for _ in range(50):
        change, state = adam.descend(state, slope, 0.1)
        np.testing.assert_allclose(change, [-0.1], rtol=1e-6)
    assert state.count == 50


def test_means_are_those_of_the_paper(float64):
    slopes = np.random.default_rng(0).normal(size=(7, 4))
    state = adam.begin(jnp.zeros(4))
    for slope in slopes:
        change, state = adam.descend(state, jnp.asarray(slope), 0.01)
    weights = 0.9 ** np.arange(6, -1, -1), 0.999 ** np.arange(6, -1, -1)
    mean = weights[0] @ slopes / weights[0].sum()
    square = weights[1] @ slopes**2 / weights[1].sum()
    np.testing.assert_allclose(change, -0.01 * mean / (np.sqrt(square) + 1e-8), rtol=1e-9)


def test_it_finds_the_bottom_of_a_narrow_valley(float64):
    scale, at = jnp.asarray([1.0, 100.0]), jnp.asarray([3.0, -2.0])
    state = adam.begin(at)
    for _ in range(800):
        change, state = adam.descend(state, 2 * scale * at, 0.05)
        at = at + change
    assert np.abs(at).max() < 1e-2
