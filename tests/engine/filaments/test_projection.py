"""Constraint projection: what sweeps keep and how errors fall."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import filaments
from microcosmos.build import build_rods


@pytest.fixture(params=["chain", "ring"])
def disturbed(request, float64, chain, ring):
    """A body, its rods, disturbed positions and the angles that belong to them."""
    body = chain(17) if request.param == "chain" else ring(17)
    rods = build_rods(body, float64)
    noise = 0.2 * np.random.default_rng(0).normal(size=body.positions.shape)
    positions = jnp.asarray(body.positions + noise)
    return body, rods, positions, filaments.edge_angles(positions, rods)


project = jax.jit(filaments.project, static_argnames="iterations")


def rest_of(body):
    return filaments.Rest(jnp.asarray(body.rest_angle), jnp.asarray(body.rest_length))


def length_error(positions, rods, rest):
    v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
    return float(jnp.sqrt(jnp.mean((jnp.sqrt(jnp.sum(v * v, 1)) - rest.length) ** 2)))


def joint_error(angles, body, rest):
    first, second = body.joints.T
    error = filaments.wrap(angles[second] - angles[first] - rest.angle)
    return float(jnp.sqrt(jnp.mean(error**2)))


def test_displacements_sum_to_zero(disturbed):
    body, rods, positions, angles = disturbed
    moved, _ = project(positions, angles, rods, rest_of(body), iterations=50)
    np.testing.assert_allclose(jnp.sum(moved - positions, 0), 0, atol=1e-13)


def test_displacements_sum_to_zero_in_float32(chain):
    body = chain(100)
    rods = build_rods(body)
    noise = 0.2 * np.random.default_rng(0).normal(size=body.positions.shape)
    positions = jnp.asarray(body.positions + noise, jnp.float32)
    angles = filaments.edge_angles(positions, rods)
    rest = filaments.Rest(jnp.zeros(len(body.joints)), jnp.ones(len(body.edges)))
    moved, _ = project(positions, angles, rods, rest, iterations=50)
    total = np.sum(np.asarray(moved, float) - np.asarray(positions, float), 0)
    np.testing.assert_allclose(total, 0, atol=1e-4)


def test_bending_keeps_the_mean_angle(disturbed):
    body, rods, positions, angles = disturbed
    _, turned = project(positions, angles, rods, rest_of(body), iterations=50)
    np.testing.assert_allclose(jnp.mean(turned), jnp.mean(angles), atol=1e-13)


def test_errors_of_length_and_angle_fall(disturbed):
    body, rods, positions, angles = disturbed
    rest = rest_of(body)
    lengths, joints = [], []
    for iterations in (0, 10, 100, 1000):
        x, theta = project(positions, angles, rods, rest, iterations=iterations)
        lengths.append(length_error(x, rods, rest))
        joints.append(joint_error(theta, body, rest))
    assert np.all(np.diff(lengths) < 0), lengths
    assert np.all(np.diff(joints) < 0), joints
    assert lengths[-1] <= 1e-3
    assert joints[-1] <= 1e-3


@pytest.mark.parametrize("stiffness", [0.25, 1.0])
def test_a_sweep_takes_the_share_of_its_stiffness_off_an_error(float64, chain, stiffness):
    body = chain(3)
    rods = replace(build_rods(body, float64), bend=jnp.full(1, stiffness))
    rest, angles = filaments.Rest(jnp.full(1, 0.2), jnp.ones(2)), jnp.asarray([0.3, -0.4])
    positions = jnp.asarray(body.positions)
    _, turned = filaments.project(positions, angles, rods, rest, iterations=1)
    error = turned[1] - turned[0] - 0.2
    np.testing.assert_allclose(error, -0.9 * (1 - stiffness), atol=1e-12)


def test_a_straight_chain_becomes_the_circle_it_is_asked_for(float64, chain):
    body = chain(32)
    rods = build_rods(body, float64)
    rest = filaments.Rest(jnp.full(30, 2 * np.pi / 31), jnp.ones(31))
    positions = jnp.asarray(body.positions)
    angles = filaments.edge_angles(positions, rods)
    positions, _ = project(positions, angles, rods, rest, iterations=10_000)
    centre = jnp.mean(positions[1:], 0)
    radius = jnp.sqrt(jnp.sum((positions - centre[None]) ** 2, 1))
    np.testing.assert_allclose(radius, 0.5 / np.sin(np.pi / 31), rtol=1e-5)


def test_a_satisfied_body_is_not_moved_at_all(dtype, chain):
    body = chain(12)
    rods = build_rods(body, dtype)
    positions = jnp.asarray(body.positions, dtype)
    angles = filaments.edge_angles(positions, rods)
    rest = filaments.Rest(jnp.zeros(10, dtype), jnp.ones(11, dtype))
    moved, turned = project(positions, angles, rods, rest, iterations=10)
    np.testing.assert_array_equal(moved, positions)
    np.testing.assert_array_equal(turned, angles)


def test_a_stiffness_of_zero_leaves_its_error(disturbed):
    body, rods, positions, angles = disturbed
    soft = filaments.Rods(
        rods.edges,
        rods.edge_colours,
        rods.joint_colours,
        stretch=0 * rods.stretch,
        shear=rods.shear,
        bend=0 * rods.bend,
    )
    moved, turned = project(positions, angles, soft, rest_of(body), iterations=10)
    np.testing.assert_array_equal(moved, positions)
    np.testing.assert_array_equal(turned, angles)


def test_wrapped_angles_lie_within_half_a_turn_and_have_slope_one(float64):
    angle = jnp.asarray([-10.0, -3.2, -0.1, 0.0, 3.1, 3.2, 7.0, 100.0])
    wrapped = filaments.wrap(angle)
    assert np.all(np.abs(wrapped) <= np.pi)
    np.testing.assert_allclose(jnp.sin(wrapped), jnp.sin(angle), atol=1e-13)
    np.testing.assert_array_equal(jax.vmap(jax.grad(filaments.wrap))(angle), 1)


def test_angles_follow_a_body_through_many_turns(float64, ring):
    body = ring(9)
    rods = build_rods(body, float64)
    angles = filaments.edge_angles(jnp.asarray(body.positions), rods)
    start = angles
    for turn in np.arange(0.1, 20, 0.1):
        c, s = np.cos(turn), np.sin(turn)
        positions = jnp.asarray(body.positions @ np.array([[c, s], [-s, c]]))
        angles = filaments.follow_geometry(angles, positions, rods)
    np.testing.assert_allclose(angles - start, turn, rtol=1e-12)


def test_projection_can_be_differentiated(disturbed):
    body, rods, positions, angles = disturbed
    random = np.random.default_rng(5)
    rest = rest_of(body)
    inputs = (positions, angles, rest.angle, rest.length, rods.stretch * 0.9, rods.bend * 0.9)

    def total(positions, angles, angle, length, stretch, bend):
        soft = filaments.Rods(
            rods.edges, rods.edge_colours, rods.joint_colours, stretch, rods.shear, bend
        )
        rest = filaments.Rest(angle, length)
        x, theta = project(positions, angles, soft, rest, iterations=5)
        return jnp.sum(jnp.sin(x)) + jnp.sum(theta**2)

    direction = [jnp.asarray(random.normal(size=x.shape)) for x in inputs]
    gradient = jax.grad(total, range(len(inputs)))(*inputs)
    slope = sum(jnp.sum(g * d) for g, d in zip(gradient, direction, strict=True))

    def along(h):
        return total(*(x + h * d for x, d in zip(inputs, direction, strict=True)))

    np.testing.assert_allclose(slope, (along(1e-6) - along(-1e-6)) / 2e-6, rtol=1e-6)


def test_the_gradient_is_finite_where_two_nodes_coincide(float64, chain):
    body = chain(4)
    rods = build_rods(body, float64)
    positions = jnp.zeros((4, 2))
    angles = jnp.zeros(3)

    def total(positions):
        rest = filaments.Rest(jnp.zeros(2), jnp.ones(3))
        return jnp.sum(project(positions, angles, rods, rest, iterations=3)[0] ** 2)

    assert np.all(np.isfinite(jax.grad(total)(positions)))
