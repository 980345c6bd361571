"""Direct encodings: waveforms, weights of layers and measures of the body are genes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, genomes, spec
from microcosmos.build import build_task
from microcosmos.build.scene import build_form
from microcosmos.filaments import edge_angles, wrap
from microcosmos.genomes import Drive, Vector
from microcosmos.measures import FORMS
from microcosmos.search.simulation import drive

STEPS = 40


@pytest.fixture
def grow(float64):
    """A function from a body's words and genes by part to what is simulated."""

    def make(body, genes, **control):
        control = {"encoding": "direct", "period": 20, "ramp": 0, **control}
        parts = {"body": body, "control": control, "task": {"steps": STEPS}}
        scene = spec.Scene.model_validate(parts)
        task = build_task(scene, float64)
        parts = task.encoding.parts
        values = np.concatenate([np.zeros(n) + genes.get(name, 0) for name, n in parts.items()])
        return task, driven_by(task, values)

    return make


def driven_by(task, values, phase=None):
    """World, start and rest shapes of genes, from one program."""

    @jax.jit
    def drive(values, phase):
        driven = task.encoding.drive(task.world, task.start, Vector(values), phase)
        return driven.world, driven.start, driven.inputs

    return Drive(*drive(values, phase))


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
    angle, length = np.asarray(driven.inputs.angle), np.asarray(driven.inputs.length)
    np.testing.assert_allclose(angle[7], task.encoding.controls.rest_angle)
    np.testing.assert_allclose(length[7], task.encoding.controls.rest_length)
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
    np.testing.assert_allclose(positions.mean(0), [24, 24], atol=1e-12)
    np.testing.assert_allclose(driven.inputs.angle, turn, atol=1e-12)
    np.testing.assert_allclose(driven.inputs.length, length)


@pytest.mark.parametrize("body", [STAR, {"builder": "tree", "segment_nodes": 2}])
def test_a_body_that_branches_starts_in_its_rest_shape(grow, body):
    _, driven = grow(body, {"rest_angle": 0.7, "rest_length": 0.4}, **FREE)

    @jax.jit
    def measured(positions, rods, rest):
        v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
        angles = edge_angles(positions, rods)
        found = angles[rods.joints[:, 1]] - angles[rods.joints[:, 0]]
        return jnp.hypot(v[:, 0], v[:, 1]), wrap(found - rest.angle[0])

    lengths, away = measured(driven.start.positions, driven.world.rods, driven.inputs)
    np.testing.assert_allclose(lengths, driven.inputs.length[0])
    np.testing.assert_allclose(away, 0, atol=1e-12)


def test_waves_are_scaled_as_a_network_s_outputs_are(grow):
    t = 2 * np.pi * np.arange(STEPS) / 20
    genes = {"angles": np.tile([0.5, 0.0], 7), "lengths": np.tile([0.0, -0.25], 8)}
    _, driven = grow({"nodes": 9}, genes, terms=1, angle_scale=0.4, length_scale=0.2)
    for joint in np.asarray(driven.inputs.angle).T:
        np.testing.assert_allclose(joint, 0.4 * 0.5 * np.sin(t), atol=1e-12)
    for edge in np.asarray(driven.inputs.length).T:
        np.testing.assert_allclose(edge, 1 - 0.2 * 0.25 * np.cos(t), atol=1e-12)


def test_an_edge_alone_has_a_wave_and_no_joint(grow):
    body = {"builder": "polyline", "points": [[0, 0], [1, 0]]}
    _, driven = grow(body, {"lengths": [0.5, 0.0]}, terms=1, length_scale=0.2)
    assert driven.inputs.angle.shape == (STEPS, 0)
    wave = np.sin(2 * np.pi * np.arange(STEPS) / 20)
    np.testing.assert_allclose(driven.inputs.length[:, 0], 1 + 0.1 * wave, atol=1e-12)


TWO = {
    "builder": "graph",
    "nodes": [*([x, 0] for x in range(3)), *([x, 6] for x in range(8))],
    "edges": [[0, 1], [1, 2], *([x, x + 1] for x in range(3, 10))],
}
BODIES = [{"nodes": 9}, STAR, {"builder": "ring", "nodes": 7}, TWO]


@pytest.mark.parametrize("body", BODIES, ids=["chain", "star", "ring", "two"])
def test_measures_are_of_the_body_that_is_inherited(grow, body):
    task, _ = grow(body, {}, **FREE, max_speed=None, max_bend=None, lag=0)
    count = sum(task.encoding.parts.values())
    values = np.random.default_rng(3).uniform(-1, 1, count)
    values[count - sum(task.encoding.parts[name] for name in ("angles", "lengths")) :] = 0
    driven = jax.jit(lambda values: developed(task, values))(values)
    world, start, rest, length, form = driven
    edges, positions = np.asarray(world.rods.edges), np.asarray(start.positions)
    lengths = np.asarray(rest.length[0])
    own = bodies.from_edges(positions, edges, rest_length=lengths)
    np.testing.assert_allclose(length, bodies.extent(own), rtol=1e-12)
    assert length != pytest.approx(task.length, rel=1e-3)
    expected = build_form(own)
    np.testing.assert_allclose([form[name] for name in FORMS], expected, rtol=1e-5)
    before, piece = np.asarray(task.start.positions), bodies.pieces(edges, len(positions))
    for one in range(piece.max() + 1):  # Filaments stay apart.
        middles = (nodes[piece == one].mean(0) for nodes in (positions, before))
        np.testing.assert_allclose(*middles, atol=1e-12)


def developed(task, values):
    driven = drive(task, Vector(values), differentiable=True)
    return driven.world, driven.start, driven.inputs, driven.length, driven.form


def test_the_length_of_a_body_can_be_differentiated(grow, require_slope):
    task, _ = grow({"nodes": 6}, {}, **FREE)
    count = sum(task.encoding.parts.values())
    values = np.random.default_rng(0).uniform(-1, 1, count)
    require_slope(lambda values: developed(task, values)[3], values, seed=1)


@pytest.mark.parametrize("stiff", [True, False], ids=["matched", "swept"])
def test_an_inherited_bend_is_none_that_actuators_add(grow, stiff):
    free = {"rest_angle": {"low": -0.4, "high": 0.4}}
    free |= {} if stiff else {"stretch": {"low": 0.2, "high": 1.0}}
    task, _ = grow({"nodes": 9}, {}, **free, max_bend=1.0, max_speed=None, lag=0)
    values = np.zeros(sum(task.encoding.parts.values()))
    values[:7] = 1.0  # In all 2.8 rad.
    rest = jax.jit(lambda values: developed(task, values)[2])(values)
    np.testing.assert_allclose(rest.angle, 0.4, atol=1e-12)


def test_start_shapes_can_be_differentiated(grow, require_slope):
    task, _ = grow({"nodes": 6}, {}, **FREE)

    def tip(values):
        driven = task.encoding.drive(task.world, task.start, Vector(values), None)
        return driven.start.positions[0, 1] + driven.inputs.length[3, 2]

    count = sum(task.encoding.parts.values())
    require_slope(tip, np.random.default_rng(0).uniform(-1, 1, count), seed=1)


PERIOD, STEPS = 24.0, 60


@pytest.fixture
def weights():
    return np.random.default_rng(4).uniform(-0.3, 0.3, (3, 6))


@pytest.fixture
def phase(float64):
    return genomes.phases(genomes.sine_cosine(STEPS, PERIOD), float64)


def waved(basis, phase, terms, weights):
    """Waves of a row of weights each, from one program."""
    wave = jax.jit(lambda phase, flat: genomes.wave(basis(phase, terms), flat, len(weights)))
    return np.asarray(wave(phase, weights.reshape(-1)))


@pytest.mark.fast
def test_a_series_is_the_sum_of_its_harmonics(weights, phase):
    found = waved(genomes.fourier, phase, 3, weights)
    t = 2 * np.pi * np.arange(STEPS) / PERIOD
    for item, (*sines, a, b, c) in enumerate(weights):
        expected = sum(s * np.sin((k + 1) * t) for k, s in enumerate(sines))
        expected += a * np.cos(t) + b * np.cos(2 * t) + c * np.cos(3 * t)
        np.testing.assert_allclose(found[:, item], expected, atol=1e-13)


@pytest.mark.fast
@pytest.mark.parametrize("terms", [2, 5, 6])
def test_a_table_is_interpolated_and_closes_upon_itself(weights, phase, terms):
    rows = weights[:, :terms]
    found = waved(genomes.table, phase, terms, rows)
    places = np.arange(STEPS) / PERIOD * terms
    for item, row in enumerate(rows):
        expected = np.interp(places, np.arange(terms), row, period=terms)
        np.testing.assert_allclose(found[:, item], expected, atol=1e-12)
