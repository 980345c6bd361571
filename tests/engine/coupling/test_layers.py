"""Two layers beside a filament, in the place of its nodes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, coupling, filaments, groups
from microcosmos.build import build_rods
from microcosmos.coupling.layers import OFFSET

SIZE = (48, 48)


@pytest.fixture
def curved(float64):
    """Two bent filaments and the normals at their nodes."""
    one = bodies.arc(12, 1.0, 0.4)
    pair = bodies.together([bodies.placed(one, (14.0, 20.0)), bodies.placed(one, (30.0, 24.0))])
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


def test_one_layer_is_the_nodes(curved):
    _, positions, normals = curved
    np.testing.assert_array_equal(coupling.points(positions, normals, 1), positions)


@pytest.mark.parametrize("layers", [1, 2])
def test_what_points_have_of_their_node_is_what_the_node_gets_back(layers, curved):
    _, positions, _ = curved
    back = coupling.at_nodes(coupling.at_points(positions, layers), layers)
    np.testing.assert_allclose(back, positions, rtol=1e-15)


def test_edges_that_cancel_have_no_normal_and_no_nan(float64):
    body = bodies.star(4, 3, 1.0)
    rods, positions = build_rods(body, float64), jnp.asarray(body.positions)
    angles = filaments.edge_angles(positions, rods)
    normals = np.asarray(filaments.normals(angles, rods, len(positions)))
    middle = int(np.argmin(np.hypot(*(body.positions - body.positions.mean(0)).T)))
    np.testing.assert_allclose(normals[middle], 0, atol=1e-6)
    np.testing.assert_allclose(np.hypot(*np.delete(normals, middle, 0).T), 1, rtol=1e-9)


def forced(body, points, target, velocity, rho, layers, limit):
    """Freed of force and torque of each body."""
    which = groups.Groups(jnp.asarray(body.member), 2).repeated(layers)

    @jax.jit
    def found(points, target, velocity, rho):
        return coupling.multi_direct_forcing(
            velocity,
            target,
            points,
            rho,
            coupling.windows(points, SIZE),
            groups=which,
            iterations=3,
            projection=coupling.torque_free,
            limit=limit,
        )

    return found(points, target, velocity, rho)


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


def test_with_layers_the_shape_that_was_asked_for_is_kept(curved):
    body, positions, normals = curved
    points = coupling.points(positions, normals, 2)
    asked = jnp.asarray(0.05 * np.random.default_rng(0).normal(size=positions.shape))
    target = coupling.at_points(asked, 2)
    found = forced(body, points, target, jnp.zeros_like(points), jnp.ones(SIZE), 2, None)
    change = np.asarray(coupling.at_nodes(found.target, 2) - asked)
    for which in range(2):
        moved, x = (a[body.member == which] for a in (change, body.positions))
        between, apart = moved[:, None] - moved[None], x[:, None] - x[None]
        np.testing.assert_allclose(np.sum(between * apart, -1), 0, atol=1e-14)
