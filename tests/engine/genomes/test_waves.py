"""Waveforms are sums of harmonics, or straight lines through a table."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes

pytestmark = pytest.mark.fast

PERIOD, STEPS = 24.0, 60


@pytest.fixture
def weights():
    return np.random.default_rng(4).uniform(-0.3, 0.3, (3, 6))


@pytest.fixture
def phase(float64):
    return genomes.phases(genomes.sine_cosine(STEPS, PERIOD), float64)


def test_a_series_is_the_sum_of_its_harmonics(weights, phase):
    found = genomes.wave(genomes.fourier(phase, 3), jnp.asarray(weights.reshape(-1)), 3)
    t = 2 * np.pi * np.arange(STEPS) / PERIOD
    for item, (*sines, a, b, c) in enumerate(weights):
        expected = sum(s * np.sin((k + 1) * t) for k, s in enumerate(sines))
        expected += a * np.cos(t) + b * np.cos(2 * t) + c * np.cos(3 * t)
        np.testing.assert_allclose(found[:, item], expected, atol=1e-13)


@pytest.mark.parametrize("terms", [2, 5, 6])
def test_a_table_is_interpolated_and_closes_upon_itself(weights, phase, terms):
    rows = weights[:, :terms]
    found = genomes.wave(genomes.table(phase, terms), jnp.asarray(rows.reshape(-1)), 3)
    places = np.arange(STEPS) / PERIOD * terms
    for item, row in enumerate(rows):
        expected = np.interp(places, np.arange(terms), row, period=terms)
        np.testing.assert_allclose(found[:, item], expected, atol=1e-12)


def test_a_linear_timer_runs_through_the_table_once(weights, float64):
    phase = genomes.phases(genomes.linear(STEPS, PERIOD), float64)
    found = genomes.wave(genomes.table(phase, 6), jnp.asarray(weights.reshape(-1)), 3)
    places = 6 * np.arange(STEPS) / STEPS
    expected = np.interp(places, np.arange(6), weights[1], period=6)
    np.testing.assert_allclose(found[:, 1], expected, atol=1e-12)


def test_what_is_asked_stays_within_one(phase):
    found = genomes.wave(genomes.fourier(phase, 2), jnp.ones(8), 2)
    assert (np.max(found), np.min(found)) == (1, -1)
