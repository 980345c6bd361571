"""A direct encoding's genes are measures of the body and the control of its parts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, spec
from microcosmos.build import build_task
from microcosmos.filaments import edge_angles, wrap
from microcosmos.genomes import Vector

STEPS = 40


@pytest.fixture
def grow(float64):
    """A function from a body's words and genes by part to what is simulated."""

    def make(body, genes, **control):
        scene = spec.Scene.model_validate(
            {
                "body": body,
                "control": {"encoding": "direct", "period": 20, "ramp": 0, **control},
                "task": {"steps": STEPS},
            }
        )
        task = build_task(scene, float64)
        parts = task.encoding.parts
        values = np.concatenate([np.zeros(n) + genes.get(name, 0) for name, n in parts.items()])
        driven = task.encoding.drive(task.world, task.start, Vector(jnp.asarray(values)), None)
        return task, driven

    return make


FREE = {
    "rest_angle": {"low": -0.2, "high": 0.2},
    "rest_length": {"low": 0.5, "high": 1.5},
    "stretch": {"low": 0.2, "high": 1.0},
    "bend": {"low": 0.0, "high": 0.5},
}
STAR = {"builder": "star", "arms": 4, "arm_nodes": 3}


@pytest.mark.parametrize(
    "body", [{"nodes": 9}, {"builder": "arc", "nodes": 9}, STAR, {"builder": "tree"}]
)
def test_genes_of_zero_are_the_middle_of_all_bounds(grow, body):
    task, driven = grow(body, {}, **FREE)
    np.testing.assert_allclose(driven.start.positions, task.start.positions, atol=1e-12)
    np.testing.assert_allclose(driven.inputs.angle[7], task.encoding.controls.rest_angle)
    np.testing.assert_allclose(driven.inputs.length[7], task.encoding.controls.rest_length)
    rods = driven.world.rods
    for found, expected in ((rods.stretch, 0.6), (rods.bend, 0.25), (rods.shear, 1.0)):
        np.testing.assert_allclose(found, expected)


def test_equal_turns_and_lengths_make_an_arc_of_a_circle(grow):
    _, driven = grow({"nodes": 9}, {"rest_angle": 1.0, "rest_length": -0.5}, **FREE)
    length, turn = 0.75, 0.2
    radius = length / 2 / np.sin(turn / 2)
    positions = np.asarray(driven.start.positions)
    chord = np.linalg.norm(positions[-1] - positions[0])
    np.testing.assert_allclose(chord, 2 * radius * np.sin(8 * turn / 2), rtol=1e-12)
    np.testing.assert_allclose(positions.mean(0), [32, 32], atol=1e-12)
    np.testing.assert_allclose(driven.inputs.angle, turn, atol=1e-12)
    np.testing.assert_allclose(driven.inputs.length, length)


@pytest.mark.parametrize("body", [STAR, {"builder": "tree", "segment_nodes": 2}])
def test_a_body_that_branches_starts_in_its_rest_shape(grow, body):
    _, driven = grow(body, {"rest_angle": 0.7, "rest_length": 0.4}, **FREE)
    rods, positions = driven.world.rods, driven.start.positions
    v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
    np.testing.assert_allclose(jnp.hypot(v[:, 0], v[:, 1]), driven.inputs.length[0])
    angles = edge_angles(positions, rods)
    found = angles[rods.joints[:, 1]] - angles[rods.joints[:, 0]]
    np.testing.assert_allclose(wrap(found - driven.inputs.angle[0]), 0, atol=1e-12)


def test_waves_are_scaled_as_a_network_s_outputs_are(grow):
    t = 2 * np.pi * np.arange(STEPS) / 20
    genes = {"angles": np.tile([0.5, 0.0], 7), "lengths": np.tile([0.0, -0.25], 8)}
    _, driven = grow({"nodes": 9}, genes, terms=1, angle_scale=0.4, length_scale=0.2)
    for joint in driven.inputs.angle.T:
        np.testing.assert_allclose(joint, 0.4 * 0.5 * np.sin(t), atol=1e-12)
    for edge in driven.inputs.length.T:
        np.testing.assert_allclose(edge, 1 - 0.2 * 0.25 * np.cos(t), atol=1e-12)


def test_a_phase_moves_the_wave_ahead(grow):
    genes = {"angles": np.tile([0.5, 0.1, 0.2, -0.3], 7)}
    task, driven = grow({"nodes": 9}, genes)
    values = np.concatenate([np.tile([0.5, 0.1, 0.2, -0.3], 7), np.zeros(4 * 8)])
    quarter = jnp.asarray(np.pi / 2)
    ahead = task.encoding.drive(task.world, task.start, Vector(jnp.asarray(values)), quarter)
    np.testing.assert_allclose(ahead.inputs.angle[:20], driven.inputs.angle[5:25], atol=1e-12)


def test_turns_of_joints_around_a_branch_are_independent():
    body = bodies.star(4, 3, 1.0)
    found = bodies.unfolded(body)
    assert len(body.joints) == 12
    assert len(found.joints) == len(body.edges) - 1 == 11
    assert np.linalg.matrix_rank(found.turned) == 11


def test_newcomers_differ_and_stay_within_their_spread(grow):
    task, _ = grow({"nodes": 9}, {}, spread=0.5, faintest=0.01, **FREE)
    keys = jax.random.split(jax.random.key(0), 200)
    values = jax.vmap(lambda key: task.encoding.newcomer(key=key).values)(keys)
    parts = jax.vmap(task.encoding.divided)(values)
    assert len(np.unique(np.asarray(values), axis=0)) == 200
    assert 0.49 < np.abs(parts["rest_angle"]).max() <= 0.5
    for name in ("angles", "lengths"):
        # Even on a log scale from 0.5 to 0.005: the mean is in the middle.
        strongest = np.log(np.abs(parts[name]).max(1))
        assert abs(strongest.mean() - np.log(0.05)) < 3 * np.log(100) / np.sqrt(12 * 200)
    strength = [np.log(np.abs(parts[name]).max(1)) for name in ("angles", "lengths")]
    assert abs(np.corrcoef(*strength)[0, 1]) < 0.25


def test_start_shapes_can_be_differentiated(grow):
    task, _ = grow({"nodes": 6}, {}, **FREE)
    count = sum(task.encoding.parts.values())

    def tip(values):
        driven = task.encoding.drive(task.world, task.start, Vector(values), None)
        return driven.start.positions[0, 1] + driven.inputs.length[3, 2]

    at = jnp.asarray(np.random.default_rng(0).uniform(-1, 1, count))
    along = jnp.asarray(np.random.default_rng(1).normal(size=count))
    slope = jnp.sum(jax.grad(tip)(at) * along)
    numeric = (tip(at + 1e-6 * along) - tip(at - 1e-6 * along)) / 2e-6
    np.testing.assert_allclose(slope, numeric, rtol=1e-6)
