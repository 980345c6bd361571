"""Actuators that tire: the viscosity at which they have half of their strength."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies
from microcosmos import world as worlds
from validation import scenes

VISCOSITY = 0.1


@pytest.fixture
def bending(float64):
    """A filament that is asked to bend, with half of the stiffness and with all of it."""
    one, half = (bodies.chain(12, 1.0, bend=bend) for bend in (1.0, 0.5))
    box, start = scenes.immersed(one, VISCOSITY, float64, size=(32, 32))
    softer, _ = scenes.immersed(half, VISCOSITY, float64, size=(32, 32))
    rest = jax.tree.map(lambda x: x[0], scenes.rest(one, np.full((1, 10), 0.2), float64))

    def moved(box):
        return worlds.move(box, start, rest, jnp.zeros_like(start.positions)).target

    return box, softer, moved


def test_at_nu_c_bends_have_half_of_their_stiffness(bending):
    box, softer, moved = bending
    tired = replace(box, nu_c=jnp.asarray(VISCOSITY))
    np.testing.assert_allclose(moved(tired), moved(softer), atol=1e-14)
    assert np.abs(moved(tired) - moved(box)).max() > 0.01


def test_far_below_nu_c_nothing_tires(bending):
    box, _, moved = bending
    fresh = replace(box, nu_c=jnp.asarray(1e9 * VISCOSITY))
    np.testing.assert_allclose(moved(fresh), moved(box), atol=1e-8)


def test_far_above_nu_c_nothing_moves(bending):
    box, _, moved = bending
    spent = replace(box, nu_c=jnp.asarray(1e-9 * VISCOSITY))
    np.testing.assert_allclose(moved(spent), 0, atol=1e-7)
