"""A CPPN grows a chain: how many nodes, how long, how bent, how stiff."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import spec
from microcosmos.build import build_task
from microcosmos.genomes import Drive

NODES = 10


@pytest.fixture
def task(float64):
    """The task of a chain that grows from 4 to 10 nodes."""
    control = spec.Grown(wave_number=None, min_nodes=4, shear=None)
    scene = spec.Scene(
        world=spec.World(width=32, height=32),
        body=spec.Chain(nodes=NODES),
        control=control,
        task=spec.Task(steps=10),
    )
    names = ("body_rest_angle", "body_rest_length", "body_stretch", "body_bend", "growth")
    assert control.outputs[2:] == names
    return build_task(scene, float64, room=(16, 32))


@pytest.fixture
def lines(network_of, float64):
    """A function that makes a network whose outputs are straight lines over the position."""

    def make(slopes, biases):
        links = {(0, 3 + output): slope for output, slope in enumerate(slopes)}
        identities = ["identity"] * len(slopes)
        return network_of(links, 3, identities, biases, dtype=float64, room=(16, 32))

    return make


def driven_by(task, genes):
    """World, start, rest shapes and length that genes develop, from one program."""

    @jax.jit
    def drive(genes):
        driven = task.encoding.drive(task.world, task.start, genes, None)
        return driven.world, driven.start, driven.inputs, driven.length

    box, start, inputs, length = drive(genes)
    return Drive(box, start, inputs, length=length)


@pytest.mark.parametrize(
    ("slope", "bias", "nodes"), [(0, 1, 10), (0, -1, 4), (-1, 0.4, 7), (1, 0.9, 4)]
)
def test_the_chain_ends_where_growth_stops(task, lines, slope, bias, nodes):
    genes = lines([0, 0, 0, 0, 0, 0, slope], [0, 0, 0, 0, 0, 0, bias])
    driven = driven_by(task, genes)
    np.testing.assert_array_equal(driven.world.present, np.arange(NODES) < nodes)
    there = np.asarray(driven.start.positions)[:nodes]
    np.testing.assert_allclose(np.mean(there, 0), [16, 16], atol=1e-12)
    np.testing.assert_allclose(driven.length, nodes - 1)
    assert np.count_nonzero(driven.world.rods.stretch) == nodes - 1
    assert np.count_nonzero(driven.world.rods.bend) == nodes - 2


def test_measures_are_read_at_nodes_and_between_them(task, lines):
    slopes = [0, 0, 0.5, 0.3, -0.4, 0.2, 0]
    biases = np.array([0, 0, 0.1, 0.2, 0.3, -0.1, 1])
    genes = lines(slopes, biases)
    driven = driven_by(task, genes)
    p = 2 * np.arange(NODES) / (NODES - 1) - 1
    lines = np.array(slopes)[:, None] * p[None] + biases[:, None]
    at_edges = np.tanh(0.5 * (lines[:, :-1] + lines[:, 1:]))
    at_joints = np.tanh(lines[:, 1:-1])
    rods = driven.world.rods
    length, angle = np.asarray(driven.inputs.length), np.asarray(driven.inputs.angle)
    np.testing.assert_allclose(length[0], 1 + 0.25 * at_edges[3], rtol=1e-6)
    np.testing.assert_allclose(rods.stretch, 0.75 + 0.25 * at_edges[4], rtol=1e-6)
    np.testing.assert_allclose(rods.bend, 0.55 + 0.45 * at_joints[5], rtol=1e-6)
    np.testing.assert_allclose(rods.shear, 1.0)
    turn = 0.15 * at_joints[2]
    np.testing.assert_allclose(angle[0], turn, rtol=1e-6)
    v = np.diff(np.asarray(driven.start.positions), axis=0)
    np.testing.assert_allclose(np.diff(np.arctan2(v[:, 1], v[:, 0])), turn, rtol=1e-5)
    np.testing.assert_allclose(np.hypot(*v.T), length[0], rtol=1e-6)


def test_newcomers_grow_to_different_sizes(task):
    keys = jax.random.split(jax.random.key(5), 40)

    def nodes(key):
        genes = task.encoding.newcomer(key=key)
        return jnp.sum(task.encoding.grow(task.world, task.start, genes).world.present)

    found = np.asarray(jax.jit(jax.vmap(nodes))(keys))
    assert {4, 10} < set(found.tolist())
