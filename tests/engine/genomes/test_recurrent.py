"""Networks with cycles: one update a step, values that live from step to step."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, spec
from microcosmos.build import build_task
from microcosmos.search import simulate

NAMES = list(genomes.ACTIVATIONS)
PLAIN = {"tanh": np.tanh, "sin": np.sin, "gaussian": lambda z: np.exp(-z * z)}


def cyclic(inputs, dtype):
    """Hidden nodes that feed themselves and each other."""
    genes, a, b = genomes.empty(12, 16), inputs + 2, inputs + 3
    bend, stretch = inputs, inputs + 1
    links = {
        (0, a): 1.2,
        (1, a): -0.7,
        (a, a): 0.8,
        (a, b): 1.1,
        (b, a): -0.6,
        (b, bend): 0.9,
        (a, stretch): 0.5,
        (bend, b): 0.4,
    }
    if inputs == 4:
        links[3, a] = 0.9
    used, count = inputs + 4, len(links)
    genes.node_used[:used] = True
    genes.node_id[:used] = np.arange(used)
    genes.activation[inputs:used] = [NAMES.index(n) for n in ("tanh", "sin", "gaussian", "sin")]
    genes.bias[inputs:used] = [0.1, -0.2, 0.3, 0.05]
    genes.connection_used[:count] = genes.enabled[:count] = True
    genes.innovation[:count] = np.arange(count)
    genes.source[:count], genes.target[:count] = np.transpose(list(links))
    genes.weight[:count] = list(links.values())
    return jax.tree.map(
        lambda x: jnp.asarray(x, dtype if x.dtype == np.float32 else None), genes
    )


def recursion(network, timer, position):
    """Plainly, node by node of one point: outputs (time, 2)."""
    nodes = int(network.node_used.sum())
    given = 1 + len(timer)
    values, said = [0.0] * nodes, []
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
        said.append(values[given : given + 2])
    return np.array(said)


@pytest.fixture
def task(float64):
    """A function that makes a tiny recurrent task."""

    def make(**control):
        scene = spec.Scene.model_validate(
            {
                "world": {"width": 16, "height": 16}
                | ({"energy": {"width": 3}} if control.get("sense_energy") else {}),
                "body": {"nodes": 5},
                "control": {"recurrent": True, "period": 9, "ramp": 0, **control},
                "task": {"steps": 20},
            }
        )
        return build_task(scene, float64, room=(12, 16))

    return make


def test_values_follow_the_plain_recursion(task, float64):
    whole, network = task(), cyclic(3, float64)
    rest = whole.encoding.drive(whole.world, whole.start, network, None).inputs
    controls = whole.encoding.controls
    for joint, node in enumerate(controls.joint_nodes):
        said = recursion(network, controls.timer, controls.position[node])
        expected = controls.angle_scale * np.tanh(said[:, 0])
        np.testing.assert_allclose(rest.angle[:, joint], expected, rtol=1e-12, atol=1e-14)
    ends = [recursion(network, controls.timer, controls.position[node]) for node in (0, 1)]
    length = 1 + controls.length_scale * 0.5 * sum(np.tanh(said[:, 1]) for said in ends)
    np.testing.assert_allclose(rest.length[:, 0], length, rtol=1e-12)


def test_without_hidden_nodes_a_recurrent_network_is_a_feed_forward_one(task, float64):
    whole = task()
    network = genomes.minimal(jax.random.key(3), 3, 2, 12, 16)
    network = jax.tree.map(
        lambda x: x.astype(float64) if x.dtype == jnp.float32 else x, network
    )
    plain = replace(whole.encoding, recurrent=False)
    one = whole.encoding.drive(whole.world, whole.start, network, None).inputs
    other = plain.drive(whole.world, whole.start, network, None).inputs
    np.testing.assert_allclose(one.angle, other.angle, rtol=1e-12)


def test_a_closed_loop_that_senses_nothing_is_the_open_one(task, float64):
    opened, closed = task(), task(sense_energy=True)
    start = replace(closed.start, energy=jnp.zeros_like(closed.start.energy))
    see = lambda state, measures: measures.rest  # noqa: E731
    driven = closed.encoding.drive(closed.world, start, cyclic(4, float64), None)
    end, applied = jax.jit(lambda: simulate(driven, see))()
    network = cyclic(3, float64)
    expected = opened.encoding.drive(opened.world, opened.start, network, None).inputs
    np.testing.assert_allclose(applied.angle, expected.angle, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(applied.length, expected.length, rtol=1e-12)
    assert end.memory.shape == (12, 5)


def test_gradients_flow_through_time(task, float64):
    whole, network = task(), cyclic(3, float64)

    @jax.jit
    def last(weight):
        driven = whole.encoding.drive(
            whole.world, whole.start, replace(network, weight=weight), None
        )
        return jnp.sum(driven.inputs.angle[-1])

    along = jnp.asarray(np.random.default_rng(2).normal(size=network.weight.shape))
    slope = jnp.sum(jax.grad(last)(network.weight) * along)
    ahead, behind = (last(network.weight + h * along) for h in (1e-6, -1e-6))
    np.testing.assert_allclose(slope, (ahead - behind) / 2e-6, rtol=1e-6)
    assert abs(slope) > 1e-3
