"""Multi-direct forcing: what it removes and what it reaches."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling, groups

SIZE = (32, 32)


@pytest.fixture
def scene(float64):
    """A bent filament in a fluid of uneven density, with velocities that do not agree."""
    random = np.random.default_rng(0)
    x = np.arange(20.0)
    positions = np.stack([6 + x, 16 + 2 * np.sin(x / 3)], 1)
    fluid_velocity = 0.02 * random.normal(size=positions.shape)
    return {
        "velocity": jnp.asarray(fluid_velocity),
        "target": jnp.asarray(fluid_velocity + 0.05 * np.stack([np.cos(x), np.sin(x / 2)], 1)),
        "positions": jnp.asarray(positions),
        "rho": jnp.asarray(1 + 0.02 * random.normal(size=SIZE)),
    }


def force(scene, iterations, projection=coupling.torque_free, limit=None):
    at = coupling.windows(scene["positions"], SIZE)
    return coupling.multi_direct_forcing(
        **scene,
        at=at,
        groups=groups.one(len(scene["positions"])),
        iterations=iterations,
        projection=projection,
        limit=limit,
    )


def slip(scene, forced):
    """How far the forced fluid misses the target, root mean square over nodes."""
    at = coupling.windows(scene["positions"], SIZE)
    change = coupling.spread(forced.forcing, at, SIZE)
    reached = coupling.interpolate(change, coupling.divided(at, scene["rho"]))
    return float(jnp.sqrt(jnp.mean((forced.target - scene["velocity"] - reached) ** 2)))


def force_and_torque(scene, q):
    x = scene["positions"]
    return np.abs(jnp.sum(q, 0)).max(), abs(jnp.sum(x[:, 0] * q[:, 1] - x[:, 1] * q[:, 0]))


@pytest.mark.parametrize("iterations", [1, 3, 10])
def test_a_torque_free_body_exerts_neither_force_nor_torque(scene, iterations):
    total, torque = force_and_torque(scene, force(scene, iterations).forcing)
    assert total <= 1e-15
    assert torque <= 1e-13


def test_a_force_free_body_exerts_a_torque_but_no_force(scene):
    total, torque = force_and_torque(scene, force(scene, 3, coupling.force_free).forcing)
    assert total <= 1e-15
    assert torque >= 1e-2


def test_the_literal_form_pushes_the_fluid(scene):
    scene |= {"target": scene["target"] + 0.01}
    total, _ = force_and_torque(scene, force(scene, 3, coupling.unprojected).forcing)
    assert total >= 1e-2


def test_the_target_changes_by_a_rigid_motion_only(scene):
    change = force(scene, 5).target - scene["target"]
    x = scene["positions"]
    between, apart = change[:, None] - change[None], x[:, None] - x[None]
    stretching = jnp.sum(between * apart, -1)
    np.testing.assert_allclose(stretching, 0, atol=1e-15)


@pytest.mark.parametrize("projection", [coupling.unprojected, coupling.torque_free])
def test_slip_falls_with_every_iteration(scene, projection):
    slips = [slip(scene, force(scene, n, projection)) for n in (1, 2, 3, 5, 10, 40)]
    assert np.all(np.diff(slips) < 0), slips
    assert slips[-1] <= 0.3 * slips[0], slips


@pytest.mark.parametrize("spacing", [0.1, 0.5, 1.0, 2.0])
def test_iterations_converge_for_any_packing_of_nodes(spacing, scene):
    count = 40
    line = np.stack([4 + spacing * np.arange(count), np.full(count, 16.3)], 1)
    wish = 0.05 * np.random.default_rng(0).normal(size=line.shape)
    scene |= {"positions": jnp.asarray(line), "velocity": jnp.zeros(line.shape)}
    scene |= {"target": jnp.asarray(wish)}
    slips = [slip(scene, force(scene, n)) for n in (1, 2, 4, 8, 16)]
    assert np.all(np.diff(slips) < 0), slips


def test_a_limit_scales_all_forcing_by_one_factor(scene):
    free, limited = force(scene, 3), force(scene, 3, limit=0.01)
    largest = np.sqrt(np.max(np.sum(np.asarray(limited.forcing) ** 2, 1)))
    np.testing.assert_allclose(largest, 0.01, rtol=1e-12)
    ratio = np.asarray(limited.forcing) / np.asarray(free.forcing)
    np.testing.assert_allclose(ratio, ratio[0, 0], rtol=1e-9)
    total, torque = force_and_torque(scene, limited.forcing)
    assert total <= 1e-15
    assert torque <= 1e-13


def test_a_body_that_the_fluid_already_carries_exerts_nothing(scene):
    scene |= {"target": scene["velocity"]}
    np.testing.assert_array_equal(force(scene, 3, limit=0.1).forcing, 0)


def test_forcing_can_be_differentiated(scene):
    direction = jax.tree.map(
        lambda x: jnp.asarray(np.random.default_rng(3).normal(size=x.shape)), scene
    )

    @jax.jit
    def total(scene):
        forced = force(scene, 3)
        return jnp.sum(forced.forcing**2) + jnp.sum(forced.target**2)

    def along(h):
        return total(jax.tree.map(lambda x, d: x + h * d, scene, direction))

    gradient = jax.jit(jax.grad(total))(scene)
    slope = sum(jnp.sum(gradient[name] * direction[name]) for name in scene)
    np.testing.assert_allclose(slope, (along(1e-6) - along(-1e-6)) / 2e-6, rtol=1e-6)
