"""Bodies with branches and loops under constraint projection."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments
from microcosmos.bodies import swimmers
from microcosmos.build import build_rods

project = jax.jit(filaments.project, static_argnames="iterations")


@pytest.fixture
def urchin():
    """A ring of 40 nodes with six branches of eight."""
    return swimmers.cilia(body_nodes=40, hairs=6, hair_nodes=8).body


def disturbed(body, noise, dtype):
    """The body's rods, its rest shape, and positions and angles off that."""
    rods = build_rods(body, dtype)
    shift = noise * np.random.default_rng(0).normal(size=body.positions.shape)
    positions = jnp.asarray(body.positions + shift, dtype)
    rest = filaments.Rest(
        jnp.asarray(body.rest_angle, dtype), jnp.asarray(body.rest_length, dtype)
    )
    return rods, rest, positions, filaments.edge_angles(positions, rods)


def joint_error(angles, body, rest):
    error = filaments.wrap(angles[body.joints[:, 1]] - angles[body.joints[:, 0]] - rest.angle)
    return float(jnp.sqrt(jnp.mean(error**2)))


def edge_error(positions, body):
    """Root mean square of the edges' vectors, less those at rest turned to fit best."""
    ends = jnp.asarray(body.edges)
    v = np.asarray(positions[ends[:, 1]] - positions[ends[:, 0]]) @ [1, 1j]
    rest = (body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]) @ [1, 1j]
    turn = np.vdot(rest, v)
    return np.sqrt(np.mean(np.abs(v - rest * turn / abs(turn)) ** 2))


def test_displacements_of_one_sweep_sum_to_zero_at_branches_too(float64, urchin):
    for body in (urchin, bodies.star(7, 5, 1.0), bodies.tree(5, 2, 6, 1.0, 1.6)):
        rods, rest, positions, angles = disturbed(body, 0.3, float64)
        moved, turned = project(positions, angles, rods, rest, iterations=1)
        assert np.abs(moved - positions).max() > 0.05
        np.testing.assert_allclose(jnp.sum(moved - positions, 0), 0, atol=1e-13)
        np.testing.assert_allclose(jnp.sum(turned - angles), 0, atol=1e-13)


def test_displacements_of_each_creature_sum_to_zero(float64, urchin):
    body = bodies.together([urchin, bodies.placed(bodies.star(5, 6, 1.0), (60.0, 0.0))])
    rods, rest, positions, angles = disturbed(body, 0.3, float64)
    moved, _ = project(positions, angles, rods, rest, iterations=10)
    for number in range(body.count):
        own = body.member == number
        np.testing.assert_allclose(jnp.sum((moved - positions)[own], 0), 0, atol=1e-12)


def test_a_branched_body_comes_back_to_its_rest_shape(dtype, urchin):
    rods, rest, positions, angles = disturbed(urchin, 0.3, dtype)
    moved, turned = project(positions, angles, rods, rest, iterations=1000)
    v = np.asarray(moved, float)[urchin.edges]
    length = np.hypot(*(v[:, 1] - v[:, 0]).T)
    print("edge error", edge_error(positions, urchin), edge_error(moved, urchin))
    print("rms of lengths", np.sqrt(np.mean((length - urchin.rest_length) ** 2)))
    print("joint error", joint_error(turned, urchin, rest))
    assert edge_error(positions, urchin) > 0.1
    assert edge_error(moved, urchin) <= 1e-5
    assert joint_error(turned, urchin, rest) <= 1e-5


def test_a_straight_chain_becomes_a_circle(dtype):
    body = bodies.chain(32, 1.0)
    rods = build_rods(body, dtype)
    rest = filaments.Rest(jnp.full(30, 2 * np.pi / 31, dtype), jnp.ones(31, dtype))
    positions = jnp.asarray(body.positions, dtype)
    angles = filaments.edge_angles(positions, rods)
    assert joint_error(angles, body, rest) > 0.2
    positions, angles = project(positions, angles, rods, rest, iterations=1000)
    shown = filaments.edge_angles(positions, rods)
    print("joint error", joint_error(angles, body, rest), joint_error(shown, body, rest))
    assert joint_error(angles, body, rest) <= 2e-3
    assert joint_error(shown, body, rest) <= 2e-3
