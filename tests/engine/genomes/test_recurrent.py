"""Recurrent networks and closed loops."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fields, genomes, search, spec
from microcosmos.build import build_controls, build_task
from microcosmos.search import simulate
from microcosmos.spec import Control
from validation import scenes

NAMES = list(genomes.ACTIVATIONS)
PLAIN = {"tanh": np.tanh, "sin": np.sin, "gaussian": lambda z: np.exp(-z * z)}


@pytest.fixture
def cyclic(network_of, float64):
    """A function that makes a network of hidden nodes that feed themselves and each other."""

    def make(inputs):
        bend, stretch, a, b = range(inputs, inputs + 4)
        links = {(0, a): 1.2, (1, a): -0.7, (a, a): 0.8, (a, b): 1.1, (b, a): -0.6}
        links |= {(b, bend): 0.9, (a, stretch): 0.5, (bend, b): 0.4}
        links |= {(3, a): 0.9} if inputs == 4 else {}
        activations, biases = ("tanh", "sin", "gaussian", "sin"), [0.1, -0.2, 0.3, 0.05]
        return network_of(links, inputs, activations, biases, dtype=float64)

    return make


def recursion(network, timer, position):
    """Plainly, node by node of one point: outputs (time, 2)."""
    network, timer, position = jax.device_get((network, timer, position))
    nodes = int(network.node_used.sum())
    given = 1 + len(timer)
    values, outputs = [0.0] * nodes, []
    for now in timer.T:
        values[:given] = [position, *now]
        new = list(values)
        for node in range(given, nodes):
            z = float(network.bias[node])
            for row in range(int(network.connection_used.sum())):
                if int(network.target[row]) == node:
                    z += float(network.weight[row]) * values[int(network.source[row])]
            new[node] = PLAIN[NAMES[int(network.activation[node])]](z)
        values = new
        outputs.append(values[given : given + 2])
    return np.array(outputs)


@pytest.fixture
def task(float64):
    def make(**control):
        energy = {"energy": {"width": 3}} if control.get("sense_energy") else {}
        parts = {"world": {"width": 16, "height": 16} | energy, "body": {"nodes": 5}}
        parts["control"] = {
            "recurrent": True,
            "wave_number": None,
            "period": 9,
            "ramp": 0,
            **control,
        }
        scene = spec.Scene.model_validate(parts | {"task": {"steps": 20}})
        return build_task(scene, float64, room=(12, 16))

    return make


def rest_of(task, network):
    """Rest shapes of a network in open loop, from one program."""
    encoding, given = task.encoding, (task.world, task.start)
    return jax.jit(lambda network: encoding.drive(*given, network, None).inputs)(network)


def test_values_follow_the_plain_recursion(task, cyclic):
    whole, network = task(), cyclic(3)
    rest = jax.device_get(rest_of(whole, network))
    controls = whole.encoding.controls
    for joint, node in enumerate(controls.joint_nodes):
        outputs = recursion(network, controls.timer, controls.sites[0, node])
        expected = controls.angle_scale * np.tanh(outputs[:, 0])
        np.testing.assert_allclose(rest.angle[:, joint], expected, rtol=1e-12, atol=1e-14)
    ends = [recursion(network, controls.timer, controls.sites[0, node]) for node in (0, 1)]
    length = 1 + controls.length_scale * 0.5 * sum(np.tanh(end[:, 1]) for end in ends)
    np.testing.assert_allclose(rest.length[:, 0], length, rtol=1e-12)


def test_a_closed_loop_that_senses_nothing_is_the_open_one(task, cyclic):
    opened, closed = task(), task(sense_energy=True)
    start = replace(closed.start, energy=jnp.zeros_like(closed.start.energy))

    @jax.jit
    def sensing(network):
        driven = closed.encoding.drive(closed.world, start, network, None)
        return simulate(driven, lambda _, measures: measures.rest)

    end, applied = sensing(cyclic(4))
    expected = rest_of(opened, cyclic(3))
    np.testing.assert_allclose(applied.angle, expected.angle, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(applied.length, expected.length, rtol=1e-12)
    assert end.memory.shape == (12, 5)


STEPS, SIZE = 60, (32, 32)


@pytest.fixture
def network(network_of, float64):
    """A function that makes a CPPN; what it senses has a weight."""

    def cppn(inputs, sensing=0.0):
        bend, stretch = inputs, inputs + 1
        links = {(0, bend): 1.5, (1, bend): 1.1, (2, bend): -0.8, (1, stretch): 0.6}
        if inputs == 4:
            links |= {(3, bend): sensing, (3, stretch): 0.5 * sensing}
        options = {"dtype": float64, "room": (8, 16)}
        return network_of(links, inputs, ("sin", "tanh"), [0, 0], **options)

    return cppn


@pytest.fixture
def foragers(float64):
    """A function that makes the task of two chains side by side among packets."""

    def make(senses, seed=3, **options):
        body = scenes.parallel_chains(8, 2.0)
        packets = fields.packets(SIZE, fields.Packets(3, 3.0, 1.0, seed))
        energy = fields.Energy(jnp.asarray(packets), jnp.asarray(0.05), jnp.asarray(0.1))
        box, start = scenes.immersed(body, 0.1, float64, size=SIZE, energy=energy, **options)
        control = Control(
            wave_number=None,
            period=30,
            angle_scale=0.2,
            length_scale=0.1,
            sense_energy=senses,
        )
        controls = build_controls(control, body, STEPS)
        encoding = genomes.CPPNControl(controls, (8, 16))
        return search.Task(box, start, encoding, search.Goal(1.0, 0.1))

    return make


def measured(task):
    """A function from a network, and the energy at the start, to its measures by name."""

    @jax.jit
    def found(network, energy):
        start = replace(task.start, energy=energy)
        return search.evaluate(replace(task, start=start), network)

    def named(network, energy=task.start.energy):
        evaluation = found(network, energy)
        assert evaluation.status == 0
        return dict(zip(search.MEASURES, np.asarray(evaluation.measures), strict=True))

    return named


@pytest.mark.long
def test_energy_changes_the_motion_only_if_the_network_uses_it(foragers, network):
    opened, closed = measured(foragers(False))(network(3)), measured(foragers(True))
    elsewhere = foragers(True, seed=4).start.energy
    heedless = closed(network(4, 0.0))
    assert opened["displacement"] > 0.01
    for name in ("displacement", "path_length", "bending_effort", "energy", "mach"):
        assert heedless[name] == pytest.approx(opened[name], rel=1e-9, abs=1e-12), name
    unmoved = closed(network(4, 0.0), elsewhere)["bending_effort"]
    assert unmoved == pytest.approx(opened["bending_effort"], rel=1e-12)
    here, there = closed(network(4, 1.0)), closed(network(4, 1.0), elsewhere)
    assert abs(here["bending_effort"] / there["bending_effort"] - 1) > 1e-3


@pytest.mark.long
def test_gradients_through_a_closed_loop_agree_with_finite_differences(
    foragers, network, require_slope
):
    # Weak enough that no displacement is cut: a cut is a kink.
    steric = fields.Steric(jnp.asarray(0.2), jnp.asarray(0.1), fields.binomial)
    whole, cppn = foragers(True, steric=steric), network(4, 1.0)

    def fitness(weights):
        return search.evaluate(whole, replace(cppn, weight=weights)).fitness

    assert abs(require_slope(fitness, cppn.weight, h=1e-5, seed=1)) > 1e-3
