"""Direct encodings: waveforms, weights of layers and measures of the body are genes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, genomes, spec
from microcosmos.build import build_task
from microcosmos.filaments import edge_angles, wrap
from microcosmos.genomes import Drive, Vector

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


def test_a_phase_moves_the_wave_ahead(grow):
    angles = np.tile([0.5, 0.1, 0.2, -0.3], 7)
    task, driven = grow({"nodes": 9}, {"angles": angles})
    values = np.concatenate([angles, np.zeros(4 * 8)])
    ahead = driven_by(task, values, np.float64(np.pi / 2))
    late, early = (np.asarray(one.inputs.angle) for one in (driven, ahead))
    np.testing.assert_allclose(early[:20], late[5:25], atol=1e-12)


def test_contradicting_turns_around_a_branch_are_averaged():
    body = bodies.star(4, 3, 1.0)
    found = bodies.layout(body)
    assert len(body.joints) == len(body.edges) == 12
    assert np.linalg.matrix_rank(found.turned) == 11
    turned = found.turned @ np.ones(12)
    first, second = body.joints.T
    around = np.all(body.edges[body.joints].min(2) == 0, 1)
    np.testing.assert_allclose((turned[second] - turned[first])[around], 0, atol=1e-12)
    np.testing.assert_allclose((turned[second] - turned[first])[~around], 1, atol=1e-12)


def test_newcomers_differ_and_stay_within_their_spread(grow):
    task, _ = grow({"nodes": 9}, {}, spread=0.5, faintest=0.01, **FREE)
    keys = jax.random.split(jax.random.key(0), 200)
    values = jax.jit(jax.vmap(lambda key: task.encoding.newcomer(key=key).values))(keys)
    parts = jax.device_get(jax.jit(jax.vmap(task.encoding.divided))(values))
    assert len(np.unique(np.asarray(values), axis=0)) == 200
    assert 0.49 < np.abs(parts["rest_angle"]).max() <= 0.5
    for name in ("angles", "lengths"):
        # Even on a log scale from 0.5 to 0.005: the mean is in the middle.
        strongest = np.log(np.abs(parts[name]).max(1))
        assert abs(strongest.mean() - np.log(0.05)) < 3 * np.log(100) / np.sqrt(12 * 200)
    strength = [np.log(np.abs(parts[name]).max(1)) for name in ("angles", "lengths")]
    assert abs(np.corrcoef(*strength)[0, 1]) < 0.25


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


@pytest.mark.fast
def test_a_linear_timer_runs_through_the_table_once(weights, float64):
    phase = genomes.phases(genomes.linear(STEPS, PERIOD), float64)
    found = waved(genomes.table, phase, 6, weights)
    places = 6 * np.arange(STEPS) / STEPS
    expected = np.interp(places, np.arange(6), weights[1], period=6)
    np.testing.assert_allclose(found[:, 1], expected, atol=1e-12)


@pytest.mark.fast
def test_waves_stay_within_one(phase):
    found = waved(genomes.fourier, phase, 2, np.ones((2, 4)))
    assert (np.max(found), np.min(found)) == (1, -1)


SIZES, SCALE = (3, 5, 4, 2), 1.7


def test_layers_compute_what_matrices_do(float64):
    layers = genomes.Layers(SIZES, "sin", SCALE)
    random = np.random.default_rng(0)
    genes, inputs = random.uniform(-1, 1, layers.genes), random.normal(size=(3, 7))
    values, rest = inputs, genes
    for before, after in ((3, 5), (5, 4), (4, 2)):
        rows, rest = rest[: after * (before + 1)], rest[after * (before + 1) :]
        rows = SCALE * rows.reshape(after, before + 1)
        values = rows[:, 1:] @ values + rows[:, :1]
        values = np.sin(values) if after != 2 else values
    found = jax.jit(lambda *given: genomes.forward(layers, *given))(genes, inputs)
    np.testing.assert_allclose(found, values, rtol=1e-12)
    assert not len(rest)


def test_size_and_genes_are_those_of_the_layers():
    control = spec.Weights(hidden=(5, 4))
    task = build_task(spec.Scene(control=control))
    genotype = task.encoding.newcomer(key=jax.random.key(0))
    hidden, connections = task.encoding.size(genotype)
    assert (hidden, connections) == (9, 5 * 5 + 5 * 4 + 4 * 2)
    assert genotype.values.shape == (5 * 5 + 5 + 5 * 4 + 4 + 4 * 2 + 2,)
    assert spec.gene_count(control, spec.shape(spec.Chain())) == len(genotype.values)
