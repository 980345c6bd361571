"""Controllers start at the body's own shape and stay within their scales."""

import jax
import numpy as np
import pytest

from microcosmos import genomes, neat
from microcosmos.build import build_controls
from microcosmos.spec import Chain, Control, shape

BODY = shape(Chain(nodes=12))
STEPS = 120


def controls(**changes):
    return build_controls(Control(period=40, **changes), BODY, STEPS)


@pytest.fixture(scope="module")
def network():
    return neat.minimal(jax.random.key(2), 3, 2, 8, 8)


def test_actuation_grows_from_the_rest_shape_over_the_ramp(network):
    rest = genomes.develop(network, controls(ramp=2))
    np.testing.assert_array_equal(rest.angle[0], BODY.rest_angle)
    np.testing.assert_array_equal(rest.length[0], BODY.rest_length)
    full = genomes.develop(network, controls(ramp=0))
    np.testing.assert_allclose(rest.angle[20], 0.25 * full.angle[20], rtol=1e-6)
    np.testing.assert_array_equal(rest.angle[80:], full.angle[80:])


def test_angles_and_lengths_stay_within_their_scales():
    networks = [neat.minimal(jax.random.key(k), 3, 2, 8, 8) for k in range(20)]
    for network in networks:
        rest = genomes.develop(network, controls(angle_scale=0.7, length_scale=0.2))
        assert np.abs(rest.angle).max() <= 0.7
        assert np.abs(rest.length - 1).max() <= 0.2


def test_a_periodic_timer_repeats_the_shape(network):
    rest = genomes.develop(network, controls(ramp=0))
    np.testing.assert_allclose(rest.angle[:40], rest.angle[40:80], atol=1e-5)


def test_a_linear_timer_runs_from_zero_towards_one():
    found = controls(timer="linear", position="unit")
    np.testing.assert_allclose(found.position, BODY.arc)
    np.testing.assert_allclose(found.timer, np.arange(STEPS)[None] / STEPS)


def test_signed_positions_run_from_minus_one_to_one():
    position = controls().position
    assert (position[0], position[-1]) == (-1, 1)
