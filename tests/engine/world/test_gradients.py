"""Gradients through network, body and fluid; absent nodes do nothing."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, fields, filaments, genomes, world
from microcosmos.build import build_controls
from microcosmos.device import array
from microcosmos.spec import Control


@pytest.fixture
def loss(immerse, network_of):
    def make(dtype, **form):
        body, random = bodies.chain(24, 1.0), np.random.default_rng(0)
        ends = [(0, 3), (1, 3), (2, 3), (1, 4), (2, 4), (0, 5), (1, 5), (5, 3), (5, 4)]
        links = dict(zip(ends, random.normal(size=len(ends)), strict=True))
        biases = 0.3 * random.normal(size=3)
        cppn = network_of(links, 3, ("sin", "tanh", "gaussian"), biases, dtype=dtype)
        box, start = immerse(body, dtype, viscosity=0.1, size=(48, 48), **form)
        control = Control(period=100, angle_scale=0.15, length_scale=0.05)
        controls = build_controls(control, body, 200)

        def travelled(inputs):
            weights, viscosity = inputs
            rest = genomes.develop(replace(cppn, weight=weights), controls)
            end, _ = world.rollout(replace(box, viscosity=viscosity), start, rest)
            moved = world.unwrapped(box, end) - start.positions
            return jnp.sum((jnp.mean(moved, 0) - 0.3) ** 2)

        return travelled, (cppn.weight, box.viscosity)

    return make


@pytest.mark.long
def test_gradients_of_200_coupled_steps_agree_with_finite_differences(
    loss, require_slope, float64
):
    travelled, inputs = loss(float64, limits=False)
    direction = np.random.default_rng(1).normal(size=inputs[0].shape)
    by_weights, by_viscosity = (direction, 0.0), (0 * direction, 0.1)
    # The error was 2e-9 at this step, and from 1e-4 on it grows.
    require_slope(travelled, inputs, h=1e-5, directions=[by_weights, by_viscosity])


@pytest.mark.long
@pytest.mark.parametrize("limits", [True, False])
def test_gradients_are_finite_in_float32(loss, limits):
    travelled, inputs = loss(jnp.dtype("float32"), limits=limits)
    for gradient in jax.jit(jax.grad(travelled))(inputs):
        assert gradient.dtype == jnp.float32
        assert np.all(np.isfinite(gradient))
        assert np.any(np.asarray(gradient) != 0)


STEPS, GROWN, ALL = 100, 9, 14


@pytest.fixture
def pair(immerse, float64):
    """A function that makes a whole short chain, and as much of a longer one, in two worlds."""

    def make(**options):
        form = {name: options.pop(name) for name in ("layers",) if name in options}
        boxes = []
        for nodes in (GROWN, ALL):
            body = bodies.chain(nodes, 1.0, bend=0.7)
            box, _ = immerse(body, float64, viscosity=0.05, size=(32, 32), **form)
            positions = body.positions + np.array([[11.0, 16.0]])
            box = replace(box, **options)
            if nodes == ALL:
                present = array(np.arange(ALL) < GROWN)
                rods = jax.jit(world.grown_rods)(box.rods, present)
                box = replace(box, rods=rods, present=present)
            boxes.append((box, jax.jit(world.at_rest)(box, positions)))
        return boxes

    return make


def gait(nodes):
    t, joint = np.arange(STEPS)[:, None], np.arange(nodes - 2)[None]
    angle = 0.3 * np.sin(2 * np.pi * t / 40 - 0.7 * joint)
    edge = np.arange(nodes - 1)[None]
    length = 1 + 0.1 * np.sin(2 * np.pi * t / 30 + 0.4 * edge)
    return filaments.Rest(jnp.asarray(angle), jnp.asarray(length))


def see(state, measures):
    return measures


def both_fields():
    packets = fields.packets((32, 32), fields.Packets(3, 3.0, 1.0, 2))
    return {
        "steric": fields.Steric(jnp.asarray(2.0), jnp.asarray(0.1), fields.binomial),
        "energy": fields.Energy(jnp.asarray(packets), jnp.asarray(0.05), jnp.asarray(0.1)),
    }


@pytest.mark.long
@pytest.mark.parametrize("options", [dict, lambda: {"layers": 2}, both_fields])
def test_some_nodes_of_a_chain_swim_as_a_shorter_chain(pair, options):
    (short, start), (long, begun) = pair(**options())
    run = jax.jit(lambda box, start, rest: world.rollout(box, start, rest, see))
    whole, expected = run(short, start, gait(GROWN))
    part, other = run(long, begun, gait(ALL))
    np.testing.assert_allclose(part.positions[:GROWN], whole.positions, atol=1e-10)
    np.testing.assert_array_equal(part.positions[GROWN:], begun.positions[GROWN:])
    np.testing.assert_allclose(part.angles[: GROWN - 1], whole.angles, atol=1e-10)
    np.testing.assert_allclose(part.populations[3], whole.populations[3], atol=1e-12)
    if whole.collected is not None:
        np.testing.assert_allclose(part.collected[:GROWN], whole.collected, atol=1e-12)
        np.testing.assert_array_equal(part.collected[GROWN:], 0)
    for name in ("speed", "node_speed", "held", "force", "centre", "heading", "power"):
        ours, theirs = getattr(other, name), getattr(expected, name)
        np.testing.assert_allclose(ours, theirs, atol=1e-10, err_msg=name)
    np.testing.assert_allclose(other.curvature[:, : GROWN - 2], expected.curvature, atol=1e-10)
    np.testing.assert_array_equal(other.curvature[:, GROWN - 2 :], 0)
    np.testing.assert_allclose(other.force, 0, atol=1e-13)
    assert jnp.linalg.norm(whole.positions[0] - start.positions[0]) > 0.01
