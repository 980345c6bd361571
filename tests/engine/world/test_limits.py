"""Limits of displacement and force, which random controllers need."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling, filaments, world

LIMIT = 0.1


@jax.jit
def swim(box, start, rest):
    return world.rollout(box, start, rest)[0]


@pytest.fixture
def wild(immerse, chain, float64):
    """A filament that is asked to fold up at once."""
    body = chain(24)
    box, start = immerse(body, float64, viscosity=0.1, size=(48, 48))
    turn = np.random.default_rng(0).uniform(-1, 1, len(body.joints))
    return box, start, filaments.Rest(jnp.asarray(turn), jnp.asarray(body.rest_length))


def test_no_node_moves_further_than_the_limit(wild):
    box, start, rest = wild
    motion = world.move(box, start, rest, jnp.zeros_like(start.positions))
    speed = np.sqrt(np.sum(np.asarray(motion.target) ** 2, 1))
    assert np.sum(speed >= 0.999 * LIMIT) > 5
    assert np.max(speed) <= LIMIT * (1 + 1e-12)


def test_no_forcing_exceeds_the_limit_and_sums_stay_zero(wild):
    box, start, rest = wild
    still = jnp.zeros_like(start.positions)
    motion = world.move(box, start, rest, still)
    forced = coupling.multi_direct_forcing(
        still,
        motion.target,
        start.positions,
        jnp.ones(box.size),
        coupling.windows(start.positions, box.size),
        groups=box.groups,
        iterations=3,
        projection=coupling.torque_free,
        limit=LIMIT / 4,
    )
    q, x = forced.forcing, start.positions
    np.testing.assert_allclose(np.sqrt(np.max(np.sum(np.asarray(q) ** 2, 1))), LIMIT / 4)
    np.testing.assert_allclose(jnp.sum(q, 0), 0, atol=1e-15)
    np.testing.assert_allclose(jnp.sum(x[:, 0] * q[:, 1] - x[:, 1] * q[:, 0]), 0, atol=1e-13)


def test_without_limits_the_same_body_moves_further(wild, immerse, chain):
    _, start, rest = wild
    free, _ = immerse(
        chain(24), start.positions.dtype, viscosity=0.1, size=(48, 48), limits=False
    )
    motion = world.move(free, start, rest, jnp.zeros_like(start.positions))
    assert np.max(np.sum(np.asarray(motion.target) ** 2, 1)) > (2 * LIMIT) ** 2


@pytest.mark.parametrize("viscosity", [0.001, 0.01, 0.05, 2.0])
def test_random_control_stays_finite_and_slower_than_sound(immerse, chain, erratic, viscosity):
    dtype, body = jnp.dtype("float32"), chain(32)
    box, start = immerse(body, dtype, viscosity=viscosity)
    for seed in (0, 1):
        end = swim(box, start, erratic(body, 1500, dtype, seed))
        assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(end))
        u = world.flow(box, end)
        assert np.sqrt(np.max(np.sum(np.asarray(u) ** 2, 0))) < 3**-0.5


def test_a_torque_free_projection_is_refused_where_angles_ignore_the_geometry():
    with pytest.raises(ValueError, match="theta_feedback"):
        world.Form(theta_feedback=0.0)
