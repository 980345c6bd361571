"""What a body in a fluid keeps: mass, momentum, rest and its shape."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import filaments, fluid, world


def momentum(state):
    return jnp.stack([jnp.sum(m) for m in fluid.momentum(state.populations)])


def lengths(state):
    v = jnp.diff(state.positions, axis=0)
    return jnp.sqrt(jnp.sum(v * v, 1))


@jax.jit
def swim(box, start, rest):
    """The end, and the fluid's momentum and the lengths of edges after every step."""
    return world.rollout(box, start, rest, lambda state: (momentum(state), lengths(state)))


def largest_impulse(box, start, rest):
    """The largest sum of forces, accumulated over time, that the body gave the fluid."""
    end, (given, _) = swim(box, start, rest)
    assert np.all(np.isfinite(end.positions))
    return float(np.sqrt(np.max(np.sum(np.asarray(given, float) ** 2, 1))))


@pytest.mark.parametrize("viscosity", [0.05, 0.5, 2.0])
@pytest.mark.parametrize("limits", [True, False])
def test_a_worm_gives_the_fluid_no_impulse(immerse, chain, worm, viscosity, limits, dtype):
    body = chain(32)
    box, start = immerse(body, dtype, viscosity=viscosity, limits=limits)
    rest = worm(body, dtype, period=250, periods=2)
    assert largest_impulse(box, start, rest) <= 1e-4


@pytest.mark.parametrize("viscosity", [0.05, 2.0])
def test_limits_that_act_give_the_fluid_no_impulse(immerse, chain, erratic, viscosity, dtype):
    body = chain(32)
    box, start = immerse(body, dtype, viscosity=viscosity)
    assert largest_impulse(box, start, erratic(body, 500, dtype)) <= 1e-4


def test_the_literal_form_gives_the_fluid_an_impulse(immerse, chain, worm, float64):
    body = chain(32)
    box, start = immerse(body, float64, viscosity=2.0, limits=False, projection="none")
    rest = worm(body, float64, period=250, periods=2)
    assert largest_impulse(box, start, rest) >= 1


def test_mass_is_kept_for_ten_thousand_steps_of_a_swimmer(immerse, chain, worm, dtype):
    body = chain(16)
    box, start = immerse(body, dtype, viscosity=0.05, size=(32, 32))
    rest = worm(body, dtype, period=250, periods=40)
    end, _ = swim(box, start, rest)
    drift = sum(np.sum(np.asarray(plane, float)) for plane in end.populations)
    assert np.all(np.isfinite(end.positions))
    assert abs(drift) <= 1e-6 * 32 * 32


def test_an_untouched_body_stays_exactly_at_rest(immerse, chain, hold, dtype):
    body = chain(16)
    box, start = immerse(body, dtype, viscosity=0.05, size=(32, 32))
    end, _ = swim(box, start, hold(body, 200, dtype))
    jax.tree.map(np.testing.assert_array_equal, end, start)


def test_edges_keep_their_length_while_a_worm_swims(immerse, chain, worm, float64):
    body = chain(32)
    box, start = immerse(body, float64, viscosity=0.5, limits=False)
    rest = worm(body, float64, period=250, periods=2)
    _, (_, seen) = swim(box, start, rest)
    np.testing.assert_allclose(seen, 1.0, atol=0.01)


def test_a_creature_swims_alike_wherever_it_starts(immerse, chain, worm, float64):
    body = chain(16)
    box, start = immerse(body, float64, viscosity=0.1, size=(32, 32))
    rest = worm(body, float64, period=200, periods=1)
    shift = jnp.asarray([[37.0, -11.0]])
    moved = world.at_rest(box, start.positions + shift)
    here, there = (swim(box, state, rest)[0].positions for state in (start, moved))
    np.testing.assert_allclose(there - shift, here, atol=1e-9)


def test_a_mirrored_gait_swims_the_mirrored_way(immerse, chain, worm, float64):
    body = chain(16)
    box, start = immerse(body, float64, viscosity=0.1, size=(32, 32))
    rest = worm(body, float64, period=200, periods=1)
    mirrored = filaments.Rest(-rest.angle, rest.length)
    one, other = (swim(box, start, gait)[0].positions for gait in (rest, mirrored))
    np.testing.assert_allclose(32 - other[:, 1], one[:, 1], atol=1e-9)
