"""Constraint projection: conserved sums, falling errors, rest shapes and gradients."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments
from microcosmos.bodies import swimmers
from microcosmos.build import build_rods
from microcosmos.device import array

project = jax.jit(filaments.project, static_argnames="iterations")
edge_angles, wrap = jax.jit(filaments.edge_angles), jax.jit(filaments.wrap)


def prepared(body, dtype, noise=0.0):
    """The body's rods and rest shape, and disturbed positions with their angles."""
    rods = build_rods(body, dtype)
    shift = noise * np.random.default_rng(0).normal(size=body.positions.shape)
    positions = array(body.positions + shift, dtype)
    shape = (body.rest_angle, body.rest_length)
    rest = filaments.Rest(*(array(values, dtype) for values in shape))
    return rods, rest, positions, edge_angles(positions, rods)


@pytest.fixture(params=[bodies.chain, bodies.ring], ids=["chain", "ring"])
def body(request):
    return request.param(17, 1.0)


@pytest.fixture
def disturbed(body, float64):
    return prepared(body, float64, 0.2)


@pytest.fixture
def urchin():
    """A ring of 40 nodes with six branches of eight."""
    return swimmers.cilia(body_nodes=40, hairs=6, hair_nodes=8).body


def length_error(positions, rods, rest):
    v = np.diff(np.asarray(positions)[np.asarray(rods.edges)], axis=1)[:, 0]
    return float(np.sqrt(np.mean((np.hypot(*v.T) - rest.length) ** 2)))


def joint_error(angles, body, rest):
    first, second = body.joints.T
    angles = np.asarray(angles)
    error = np.asarray(wrap(angles[second] - angles[first] - rest.angle))
    return float(np.sqrt(np.mean(error**2)))


def edge_error(positions, body):
    """Root mean square of the edges' vectors, less those at rest turned to fit best."""
    positions, ends = np.asarray(positions), body.edges
    v = (positions[ends[:, 1]] - positions[ends[:, 0]]) @ [1, 1j]
    rest = (body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]) @ [1, 1j]
    turn = np.vdot(rest, v)
    return np.sqrt(np.mean(np.abs(v - rest * turn / abs(turn)) ** 2))


def test_displacements_sum_to_zero_and_bending_keeps_the_mean_angle(disturbed):
    rods, rest, positions, angles = disturbed
    moved, turned = project(positions, angles, rods, rest, iterations=50)
    np.testing.assert_allclose(np.sum(np.asarray(moved) - positions, 0), 0, atol=1e-13)
    np.testing.assert_allclose(np.mean(turned), np.mean(angles), atol=1e-13)


def test_errors_of_length_and_angle_fall(disturbed, body):
    rods, rest, positions, angles = disturbed
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
def test_a_sweep_takes_the_share_of_its_stiffness_off_an_error(float64, stiffness):
    rods, rest, positions, _ = prepared(bodies.chain(3, 1.0), float64)
    rods = replace(rods, bend=jnp.full(1, stiffness))
    rest, angles = replace(rest, angle=jnp.full(1, 0.2)), jnp.asarray([0.3, -0.4])
    _, turned = project(positions, angles, rods, rest, iterations=1)
    error = np.diff(turned)[0] - 0.2
    np.testing.assert_allclose(error, -0.9 * (1 - stiffness), atol=1e-12)


def test_a_satisfied_body_is_not_moved_at_all(dtype):
    rods, rest, positions, angles = prepared(bodies.chain(12, 1.0), dtype)
    moved, turned = project(positions, angles, rods, rest, iterations=10)
    np.testing.assert_array_equal(moved, positions)
    np.testing.assert_array_equal(turned, angles)


def test_a_stiffness_of_zero_leaves_its_error(disturbed):
    rods, rest, positions, angles = disturbed
    soft = replace(rods, stretch=0 * rods.stretch, bend=0 * rods.bend)
    moved, turned = project(positions, angles, soft, rest, iterations=10)
    np.testing.assert_array_equal(moved, positions)
    np.testing.assert_array_equal(turned, angles)


def test_wrapped_angles_lie_within_half_a_turn_and_have_slope_one(float64):
    angle = jnp.asarray([-10.0, -3.2, -0.1, 0.0, 3.1, 3.2, 7.0, 100.0])
    wrapped = filaments.wrap(angle)
    assert np.all(np.abs(wrapped) <= np.pi)
    np.testing.assert_allclose(jnp.sin(wrapped), jnp.sin(angle), atol=1e-13)
    np.testing.assert_array_equal(jax.vmap(jax.grad(filaments.wrap))(angle), 1)


def test_angles_follow_a_body_through_many_turns(float64):
    body = bodies.ring(9, 1.0)
    rods, _, _, angles = prepared(body, float64)
    start = angles
    follow = jax.jit(filaments.follow_geometry)
    for turn in np.arange(0.1, 20, 0.1):
        c, s = np.cos(turn), np.sin(turn)
        angles = follow(angles, body.positions @ np.array([[c, s], [-s, c]]), rods)
    np.testing.assert_allclose(np.asarray(angles) - start, turn, rtol=1e-12)


@pytest.mark.long
def test_projection_can_be_differentiated(disturbed, require_slope):
    rods, rest, positions, angles = disturbed
    stiffness = (rods.stretch * 0.9, rods.bend * 0.9)

    def total(inputs):
        positions, angles, rest, (stretch, bend) = inputs
        soft = replace(rods, stretch=stretch, bend=bend)
        x, theta = project(positions, angles, soft, rest, iterations=5)
        return jnp.sum(jnp.sin(x)) + jnp.sum(theta**2)

    require_slope(total, (positions, angles, rest, stiffness), seed=5)


def test_the_gradient_is_finite_where_two_nodes_coincide(float64):
    rods, rest, positions, angles = prepared(bodies.chain(4, 1.0), float64)

    def total(positions):
        return jnp.sum(project(positions, 0 * angles, rods, rest, iterations=3)[0] ** 2)

    assert np.all(np.isfinite(jax.grad(total)(0 * positions)))


def test_displacements_of_one_sweep_sum_to_zero_at_branches_too(float64, urchin):
    for body in (urchin, bodies.star(7, 5, 1.0), bodies.tree(5, 2, 6, 1.0, 1.6)):
        rods, rest, positions, angles = prepared(body, float64, 0.3)
        moved, turned = project(positions, angles, rods, rest, iterations=1)
        assert np.abs(np.asarray(moved) - positions).max() > 0.05
        np.testing.assert_allclose(np.sum(np.asarray(moved) - positions, 0), 0, atol=1e-13)
        np.testing.assert_allclose(np.sum(np.asarray(turned) - angles), 0, atol=1e-13)


def test_a_branched_body_comes_back_to_its_rest_shape(dtype, urchin):
    rods, rest, positions, angles = prepared(urchin, dtype, 0.3)
    moved, turned = project(positions, angles, rods, rest, iterations=1000)
    assert edge_error(positions, urchin) > 0.1
    assert edge_error(moved, urchin) <= 1e-5
    assert joint_error(turned, urchin, rest) <= 1e-5
