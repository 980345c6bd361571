"""Shape matching: closed forms, the limit of many sweeps, conserved sums and gradients."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments
from microcosmos.bodies import swimmers
from microcosmos.build import build_layout, build_rods
from microcosmos.device import array

matched, rest_positions = jax.jit(filaments.matched), jax.jit(filaments.rest_positions)
edge_angles = jax.jit(filaments.edge_angles)
project = jax.jit(filaments.project, static_argnames="iterations")

BODIES = {
    "chain": bodies.chain(17, 1.0),
    "ring": bodies.ring(18, 1.0),
    "star": bodies.star(4, 5, 1.0),
    "tadpole": swimmers.tadpole(10, 8).body,
}


@pytest.fixture(params=BODIES)
def body(request):
    return BODIES[request.param]


def rest_of(body, dtype, turn=0.0, change=0.0):
    """The body's rest shape with a wave of turns and lengths along it."""
    wave = np.sin(2 * np.pi * body.arc)
    angle = body.rest_angle + turn * wave[body.joint_nodes]
    length = body.rest_length * (1 + change * wave[body.edges].mean(1))
    return filaments.Rest(array(angle, dtype), array(length, dtype))


def disturbed(body, dtype):
    shift = 0.2 * np.random.default_rng(0).normal(size=body.positions.shape)
    return array(body.positions + shift, dtype)


def test_a_chain_becomes_an_arc_of_a_circle(float64):
    rest = filaments.Rest(array(np.full(7, 0.3)), array(np.full(8, 2.0)))
    found = rest_positions(rest, build_layout(bodies.chain(9, 1.0), float64))
    angle = 0.3 * (np.arange(8) - 3.5)
    edges = 2 * np.stack([np.cos(angle), np.sin(angle)], 1)
    arc = np.concatenate([np.zeros((1, 2)), np.cumsum(edges, 0)])
    np.testing.assert_allclose(found, arc - arc.mean(0), atol=1e-12)


def test_a_body_at_rest_has_the_shape_in_which_it_is_drawn(body, float64):
    found = rest_positions(rest_of(body, float64), build_layout(body, float64))
    np.testing.assert_allclose(found, body.positions - body.positions.mean(0), atol=1e-12)


@pytest.mark.parametrize("name", ["chain", "star", "tadpole"])
def test_it_is_the_limit_of_many_sweeps(float64, name):
    """Joints at branches and in loops, where rest angles may disagree, keep their angles."""
    body = BODIES[name]
    degree = np.bincount(body.edges.reshape(-1))
    limb = (degree[body.joint_nodes] == 2) & (name != "tadpole" or body.joint_nodes >= 10)
    bent = np.where(limb, rest_of(body, float64, 0.3).angle, body.rest_angle)
    rest = filaments.Rest(array(bent), array(body.rest_length))
    rods, start = build_rods(body, float64), disturbed(body, float64)
    angles = edge_angles(start, rods)
    swept, _ = project(start, angles, rods, rest, iterations=20_000)
    found = matched(swept, rest, build_layout(body, float64))
    np.testing.assert_allclose(found, swept, atol=1e-9)
    assert np.abs(np.asarray(found) - body.positions).max() > 0.2


def test_the_mean_position_and_the_angular_momentum_are_kept(body, float64):
    start, rest = disturbed(body, float64), rest_of(body, float64, 0.1, 0.1)
    moved = np.asarray(matched(start, rest, build_layout(body, float64))) - start
    arms = np.asarray(start) - np.mean(start, 0, keepdims=True)
    spin = arms[:, 0] * moved[:, 1] - arms[:, 1] * moved[:, 0]
    np.testing.assert_allclose(np.sum(moved, 0), 0, atol=1e-12)
    np.testing.assert_allclose(np.sum(spin), 0, atol=1e-11)


def test_pieces_move_apart(float64):
    one = bodies.chain(5, 1.0)
    pair = bodies.combined([bodies.placed(one, (0, 0)), bodies.placed(one, (0, 9))])
    start = disturbed(pair, float64)
    found = np.asarray(matched(start, rest_of(pair, float64), build_layout(pair, float64)))
    alone = build_layout(one, float64)
    for part in (slice(0, 5), slice(5, 10)):
        expected = matched(np.asarray(start)[part], rest_of(one, float64), alone)
        np.testing.assert_allclose(found[part], expected, atol=1e-12)


def test_it_can_be_differentiated(body, float64, require_slope):
    layout, weights = build_layout(body, float64), np.arange(2.0 * len(body.positions))

    def value(given):
        positions, rest = given
        return jnp.sum(filaments.matched(positions, rest, layout).reshape(-1) * weights)

    require_slope(value, (disturbed(body, float64), rest_of(body, float64, 0.1, 0.1)))
