"""Multi-direct forcing: conserved sums, convergence, limits, and layers beside a filament."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, coupling, filaments, groups
from microcosmos.build import build_rods
from microcosmos.coupling import forcing
from microcosmos.coupling.forcing import OFFSET, step_lengths

SIZE = (48, 48)


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
    x = scene["positions"]
    at, alone = coupling.windows(x, SIZE), groups.single(len(x))
    options = {"iterations": iterations, "projection": projection, "limit": limit}
    return coupling.multi_direct_forcing(**scene, at=at, groups=alone, **options)


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


def test_a_force_free_body_exerts_a_torque_and_the_literal_form_pushes_the_fluid(scene):
    total, torque = force_and_torque(scene, force(scene, 3, coupling.force_free).forcing)
    assert total <= 1e-15
    assert torque >= 1e-2
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


@pytest.mark.parametrize("iterations", [1, 2, 3, 7, 20])
def test_steps_shrink_every_mode_and_overshoot_none(iterations):
    lengths, modes = step_lengths(iterations), np.linspace(0, 1, 1001)
    assert lengths[-1] == 1
    slips = np.cumprod(1 - lengths[:, None] * modes[None], 0)
    if iterations < 3:
        np.testing.assert_allclose(lengths, 1)
        return
    assert np.all(slips[-2:] >= -1e-8)
    assert np.all(iterations**2 * modes * slips[-2] <= 1 + 1e-9)
    # Rounding errors of one iteration grow by these in those that follow.
    after = np.cumprod((1 - lengths[:, None] * modes[None])[::-1], 0)
    assert np.abs(after).max() <= 1 + 1e-9


def test_the_operator_of_the_iteration_has_eigenvalues_from_zero_to_one(scene):
    at, nodes = coupling.windows(scene["positions"], SIZE), len(scene["positions"])
    change = coupling.spread(jnp.eye(nodes), at, SIZE)
    matrix = np.asarray(coupling.interpolate(change, coupling.divided(at, scene["rho"])))
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-15)
    sums = matrix.sum(1)
    values = np.linalg.eigvalsh(matrix / np.sqrt(sums[:, None] * sums[None]))
    assert values.min() >= -1e-12
    np.testing.assert_allclose(values.max(), 1, rtol=1e-12)
    # One plain iteration divides by these sums.
    still = force(scene, 1, coupling.unprojected)
    asked = np.asarray(scene["target"] - scene["velocity"])
    np.testing.assert_allclose(still.forcing, asked / sums[:, None], rtol=1e-12)


def test_ten_iterations_leave_half_of_the_slip_that_equal_steps_leave(scene, monkeypatch):
    found = slip(scene, force(scene, 10))
    monkeypatch.setattr(forcing, "step_lengths", np.ones)
    assert found <= 0.6 * slip(scene, force(scene, 10))


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


def test_forcing_can_be_differentiated(scene, require_slope):
    def total(scene):
        forced = force(scene, 3)
        return jnp.sum(forced.forcing**2) + jnp.sum(forced.target**2)

    require_slope(total, scene, seed=3)


@pytest.fixture
def curved(float64):
    one = bodies.arc(12, 1.0, 0.4)
    pair = bodies.combined([bodies.placed(one, (14.0, 20.0)), bodies.placed(one, (30.0, 24.0))])
    rods, positions = build_rods(pair, float64), jnp.asarray(pair.positions)
    angles = filaments.edge_angles(positions, rods)
    return pair, positions, filaments.normals(angles, rods, len(positions))


def test_layers_stand_half_a_cell_to_either_side(curved):
    body, positions, normals = curved
    points = np.asarray(coupling.points(positions, normals, 2)).reshape(-1, 2, 2)
    np.testing.assert_allclose(points.mean(1), positions, rtol=1e-14)
    apart = points[:, 0] - points[:, 1]
    np.testing.assert_allclose(np.hypot(*apart.T), 2 * OFFSET, rtol=1e-9)
    along = body.positions[2:12] - body.positions[:10]
    np.testing.assert_allclose(np.sum(apart[1:11] * along, 1), 0, atol=1e-9)


def test_edges_that_cancel_have_no_normal_and_no_nan(float64):
    body = bodies.star(4, 3, 1.0)
    rods, positions = build_rods(body, float64), jnp.asarray(body.positions)
    angles = filaments.edge_angles(positions, rods)
    normals = np.asarray(filaments.normals(angles, rods, len(positions)))
    middle = int(np.argmin(np.hypot(*(body.positions - body.positions.mean(0)).T)))
    np.testing.assert_allclose(normals[middle], 0, atol=1e-6)
    np.testing.assert_allclose(np.hypot(*np.delete(normals, middle, 0).T), 1, rtol=1e-9)


def forced(body, points, target, velocity, rho, layers, limit):
    options = {"iterations": 3, "projection": coupling.torque_free, "limit": limit}
    options["groups"] = groups.Groups(jnp.asarray(body.member), 2).repeated(layers)

    @jax.jit
    def found(*given):
        at = coupling.windows(points, SIZE)
        return coupling.multi_direct_forcing(*given, at, **options)

    return found(velocity, target, points, rho)


@pytest.mark.parametrize(("layers", "limit"), [(1, 0.01), (2, None), (2, 0.01)])
def test_each_of_two_bodies_exerts_neither_force_nor_torque(layers, limit, curved):
    body, positions, normals = curved
    points = coupling.points(positions, normals, layers)
    random = np.random.default_rng(0)
    target = coupling.at_points(jnp.asarray(0.05 * random.normal(size=positions.shape)), layers)
    velocity = jnp.asarray(0.01 * random.normal(size=points.shape))
    rho = jnp.asarray(1 + 0.02 * random.normal(size=SIZE))
    forcing = forced(body, points, target, velocity, rho, layers, limit).forcing
    member = np.repeat(body.member, layers)
    for which in range(2):
        q, x = (np.asarray(a)[member == which] for a in (forcing, points))
        assert np.hypot(*q.T).max() >= 0.01 * (1 - 1e-9)
        np.testing.assert_allclose(q.sum(0), 0, atol=1e-14)
        np.testing.assert_allclose(np.sum(x[:, 0] * q[:, 1] - x[:, 1] * q[:, 0]), 0, atol=1e-12)
