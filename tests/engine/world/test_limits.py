"""Limits of displacement and force, tired actuators, and bodies without a fluid."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, world
from microcosmos.device import array
from validation import scenes

LIMIT = 0.1
move, flow = jax.jit(world.move), jax.jit(world.flow)


@jax.jit
def swim(box, start, rest):
    return world.rollout(box, start, rest)[0]


@pytest.fixture
def wild(immerse, float64):
    body = bodies.chain(24, 1.0)
    box, start = immerse(body, float64, viscosity=0.1, size=(48, 48))
    turn = np.random.default_rng(0).uniform(-1, 1, len(body.joints))
    return box, start, filaments.Rest(array(turn), array(body.rest_length))


def test_no_node_moves_further_than_the_limit(wild):
    box, start, rest = wild
    motion = move(box, start, rest, jnp.zeros_like(start.positions))
    speed = np.sqrt(np.sum(np.asarray(motion.target) ** 2, 1))
    assert np.sum(speed >= 0.999 * LIMIT) > 5
    assert np.max(speed) <= LIMIT * (1 + 1e-12)


def test_without_limits_the_same_body_moves_further(wild, immerse):
    _, start, rest = wild
    body, options = bodies.chain(24, 1.0), {"size": (48, 48), "limits": False}
    free, _ = immerse(body, start.positions.dtype, viscosity=0.1, **options)
    motion = move(free, start, rest, jnp.zeros_like(start.positions))
    assert np.max(np.sum(np.asarray(motion.target) ** 2, 1)) > (2 * LIMIT) ** 2


@pytest.mark.long
@pytest.mark.parametrize("viscosity", [0.001, 0.01, 0.05, 2.0])
def test_random_control_stays_finite_and_slower_than_sound(immerse, viscosity):
    dtype, body = jnp.dtype("float32"), bodies.chain(32, 1.0)
    box, start = immerse(body, dtype, viscosity=viscosity)
    for seed in (0, 1):
        end = swim(box, start, scenes.erratic(body, 1500, dtype, seed))
        assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(end))
        u = flow(box, end)
        assert np.sqrt(np.max(np.sum(np.asarray(u) ** 2, 0))) < 3**-0.5


def test_a_torque_free_projection_is_refused_where_angles_ignore_the_geometry():
    with pytest.raises(ValueError, match="theta_feedback"):
        world.Form(theta_feedback=0.0)


VISCOSITY = 0.1


@pytest.fixture
def bending(float64):
    """A filament that is asked to bend, with half of the stiffness and with all of it."""
    one, half = (bodies.chain(12, 1.0, bend=bend) for bend in (1.0, 0.5))
    stiff, start = scenes.immersed(one, VISCOSITY, float64, size=(32, 32))
    box = replace(stiff, layout=None)  # As a world with `nu_c` is built.
    softer, _ = scenes.immersed(half, VISCOSITY, float64, size=(32, 32))
    rest = scenes.rest(one, np.full((1, 10), 0.2), float64)
    rest = jax.tree.map(lambda x: np.asarray(x)[0], rest)

    def moved(box):
        return move(box, start, rest, jnp.zeros_like(start.positions)).target

    return box, softer, moved


def test_at_nu_c_bends_have_half_of_their_stiffness(bending):
    box, softer, moved = bending
    tired = replace(box, nu_c=array(VISCOSITY))
    np.testing.assert_allclose(moved(tired), moved(softer), atol=1e-14)
    assert np.abs(np.asarray(moved(tired)) - moved(box)).max() > 0.01


def test_far_below_nu_c_nothing_tires_and_far_above_nothing_moves(bending):
    box, _, moved = bending
    fresh, spent = (replace(box, nu_c=array(x * VISCOSITY)) for x in (1e9, 1e-9))
    np.testing.assert_allclose(moved(fresh), moved(box), atol=1e-8)
    np.testing.assert_allclose(moved(spent), 0, atol=1e-7)


FORM = {"projection": "force", "theta_feedback": 0, "limits": False}


@pytest.fixture
def dry(immerse, float64):
    def make(angle, steps, **form):
        body = bodies.chain(9, 1.0)
        given = {"viscosity": 0.05, "size": (48, 48), "fluid": False} | FORM | form
        rest = scenes.rest(body, np.full((steps, 7), angle), float64)
        return *immerse(body, float64, **given), rest

    return make


@pytest.mark.parametrize("layers", [1, 2])
def test_a_filament_takes_its_rest_shape_and_its_middle_stays(dry, layers):
    box, start, rest = dry(0.3, 300, layers=layers)
    end, forces = jax.jit(lambda: world.rollout(box, start, rest, lambda s, m: m.force))()
    np.testing.assert_allclose(np.diff(end.angles), 0.3, atol=1e-6)
    steps = np.diff(end.positions, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.mean(end.positions, 0), np.mean(start.positions, 0))
    assert not np.any(forces)


def test_limits_hold_without_a_fluid_too(dry):
    box, start, rest = dry(1.0, 1, limits=True, max_displacement=0.01)
    end, _ = jax.jit(lambda: world.rollout(box, start, rest))()
    way = np.hypot(*(np.asarray(end.positions) - np.asarray(start.positions)).T)
    assert 0.0099 < way.max() <= 0.01 + 1e-12
