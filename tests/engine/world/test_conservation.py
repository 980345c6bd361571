"""A body in a fluid conserves mass, momentum, rest and its edges' lengths."""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, world
from microcosmos.bodies.swimmers import worm
from validation import scenes, swimmers

swim = jax.jit(world.rollout)


@pytest.fixture
def small():
    def make(dtype, viscosity, period, periods):
        swimmer = worm(nodes=16)
        box, start = scenes.immersed(swimmer.body, viscosity, dtype, size=(32, 32))
        return box, start, scenes.stroke(swimmer, period, periods, dtype)

    return make


@pytest.mark.long
def test_no_known_swimmer_gives_the_fluid_an_impulse():
    assert not swimmers.check_impulse(period=250).failed


@pytest.mark.long
def test_a_worm_without_limits_gives_the_fluid_no_impulse(dtype):
    assert not swimmers.check_impulse(("worm",), period=250, dtype=dtype, limits=False).failed


@pytest.mark.parametrize("viscosity", [0.05, 2.0])
def test_limits_that_act_give_the_fluid_no_impulse(viscosity, dtype):
    body = bodies.chain(32, 1.0)
    limits = scenes.limits(viscosity, dtype)
    box, start = scenes.immersed(body, viscosity, dtype, limits=limits)
    wild = scenes.erratic(body, 500, dtype, seed=0)
    assert swimmers.largest_impulse(box, start, wild) <= 1e-4


@pytest.mark.long
def test_the_literal_form_gives_the_fluid_an_impulse(float64):
    swimmer = worm()
    form = world.Form(projection=scenes.LITERAL.projection)
    box, start = scenes.immersed(swimmer.body, 2.0, float64, form=form)
    gait = scenes.stroke(swimmer, 250, 2, float64)
    assert swimmers.largest_impulse(box, start, gait) >= 1


@pytest.mark.parametrize(
    "dtype", ["float32", pytest.param("float64", marks=pytest.mark.long)], indirect=True
)
def test_mass_is_kept_for_ten_thousand_steps_of_a_swimmer(small, dtype):
    box, start, gait = small(dtype, 0.05, 250, 40)
    end, _ = swim(box, start, gait)
    drift = sum(np.sum(np.asarray(plane, float)) for plane in end.populations)
    assert np.all(np.isfinite(end.positions))
    assert abs(drift) <= 1e-6 * 32 * 32


def test_an_untouched_body_stays_exactly_at_rest(dtype):
    body = bodies.chain(16, 1.0)
    box, start = scenes.immersed(body, 0.05, dtype, size=(32, 32))
    still = scenes.held(body, 200, dtype)
    end, _ = swim(replace(box, layout=None), start, still)
    jax.tree.map(np.testing.assert_array_equal, end, start)
    # Shape matching rounds.
    end, _ = swim(box, start, still)
    rounding = partial(np.testing.assert_allclose, rtol=0, atol=1e3 * np.finfo(dtype).eps)
    jax.tree.map(rounding, end, start)


def test_edges_keep_their_length_while_a_worm_swims(float64):
    swimmer = worm()
    box, start = scenes.immersed(swimmer.body, 0.5, float64)
    positions = scenes.recorded(box, start, scenes.stroke(swimmer, 250, 2, float64))
    lengths = np.hypot(*np.moveaxis(np.diff(positions, axis=1), -1, 0))
    np.testing.assert_allclose(lengths, 1.0, atol=1e-5)


def test_a_creature_swims_alike_wherever_it_starts(small, float64):
    box, start, gait = small(float64, 0.1, 200, 1)
    shift = jnp.asarray([[37.0, -11.0]])
    moved = jax.jit(world.at_rest)(box, start.positions + shift)
    ends = (swim(box, state, gait)[0] for state in (start, moved))
    here, there = (np.asarray(world.unwrapped(box, end)) for end in ends)
    np.testing.assert_allclose(there - shift, here, atol=1e-9)


def test_a_mirrored_gait_swims_the_mirrored_way(small, float64):
    box, start, gait = small(float64, 0.1, 200, 1)
    mirrored = filaments.Rest(-gait.angle, gait.length)
    one, other = (swim(box, start, rest)[0].positions for rest in (gait, mirrored))
    np.testing.assert_allclose(32 - other[:, 1], one[:, 1], atol=1e-9)
