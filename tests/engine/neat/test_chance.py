"""Draws are uniform and independent over places, keys and neighbouring keys."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos.neat import rng

KEYS, PLACES = 4000, 60


@pytest.fixture(scope="module")
def drawn():
    """Numbers, (key, place)."""
    keys = jax.random.split(jax.random.key(0), KEYS)
    return np.asarray(jax.jit(jax.vmap(lambda k: rng.draws((PLACES,), key=k)[0]))(keys))


def test_every_interval_is_drawn_equally_often(drawn):
    bins = 64
    counts = np.histogram(drawn, bins, (0, 1))[0]
    expected = drawn.size / bins
    squares = ((counts - expected) ** 2 / expected).sum()
    assert squares == pytest.approx(bins - 1, abs=4 * (2 * (bins - 1)) ** 0.5)
    assert 0 <= drawn.min() < drawn.max() < 1


def test_places_are_uncorrelated_and_so_are_keys(drawn):
    for values in (drawn, drawn[:PLACES].T, drawn**2, np.floor(drawn * 2**20) % 2):
        between = np.corrcoef(values, rowvar=False) - np.eye(values.shape[1])
        assert np.abs(between).max() < 5.5 / len(values) ** 0.5


def test_what_a_draw_leaves_is_a_draw_again(drawn):
    for low, high in ((0.0, 0.25), (0.25, 0.9)):
        inside = drawn[(drawn >= low) & (drawn < high)]
        rest = np.asarray(rng.rescaled(jnp.asarray(inside), low, high))
        assert rest.mean() == pytest.approx(0.5, abs=4 * 0.29 / len(rest) ** 0.5)
        assert rest.std() == pytest.approx(12**-0.5, rel=0.01)


def test_whole_numbers_stay_below_their_limit():
    for total, drawn, expected in ((7, rng.LARGEST, 6), (0, rng.LARGEST, 0), (7, 0, 0)):
        assert rng.below(jnp.asarray(total), jnp.float32(drawn)) == expected
