"""Controllers in the native kernel against JAX: the same shapes in open and closed loop."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import world
from microcosmos.build import build_task
from microcosmos.genomes import CPPN
from microcosmos.search import drive
from microcosmos.search.measures import observe
from microcosmos.spec import parse

kernels = pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native

VECTORS = {"search": {"emitters": [{"operator": "iso+line"}]}}
OPEN = {
    "cppn": {},
    "no bounds": {"control": {"max_speed": None, "lag": 0, "max_bend": None}},
    "a linear timer": {"control": {"timer": "linear", "wave_number": None}},
    "slowed and bent little": {"control": {"max_speed": 0.01, "max_bend": 0.5, "period": 40}},
    "recurrent": {"control": {"recurrent": True}},
    "a body that grows": {"control": {"encoding": "cppn-body"}},
    "layers": {"control": {"encoding": "weights"}, **VECTORS},
    "layers of sigmoids": {
        "control": {"encoding": "weights", "activation": "sigmoid"},
        **VECTORS,
    },
    "series": {"control": {"encoding": "direct"}, **VECTORS},
    "table": {"control": {"encoding": "direct", "waveform": "table"}, **VECTORS},
    "a star": {"body": {"builder": "star", "arms": 3, "arm_nodes": 5}},
    "a star with anatomy": {
        "control": {"anatomy": True},
        "body": {"builder": "star", "arms": 5, "arm_nodes": 3},
    },
    "a recurrent tree with anatomy": {
        "control": {"anatomy": True, "recurrent": True, "position": "unit"},
        "body": {"builder": "tree", "levels": 2, "segment_nodes": 4},
    },
    "an arc, whose edges turn by more than half a circle": {
        "body": {"builder": "arc", "nodes": 14, "gap": 0.2}
    },
}
ENERGY = {"packets": 5, "width": 3.0}
CLOSED = {
    "senses": {"control": {"sense_energy": True}},
    "senses with memory": {"control": {"sense_energy": True, "recurrent": True}},
    "senses with layers": {"control": {"encoding": "weights", "sense_energy": True}, **VECTORS},
    "grows and senses": {"control": {"encoding": "cppn-body", "sense_energy": True}},
    "a star that senses, with anatomy": {
        "control": {"sense_energy": True, "anatomy": True},
        "body": {"builder": "star", "arms": 3, "arm_nodes": 4},
    },
    "senses without bounds": {
        "control": {"sense_energy": True, "max_speed": None, "lag": 0, "max_bend": None}
    },
    "senses with two layers": {"control": {"sense_energy": True}, "coupling": {"layers": 2}},
}


def task_of(document, energy=None, steps=200):
    small = {
        "experiment": "quality-diversity",
        "world": {"width": 32, "height": 37, "energy": energy},
        "body": {"nodes": 12},
        "task": {"steps": steps, "fitness": "displacement"},
    }
    spec = parse(small | document)
    return build_task(spec.scene, room=(spec.genome.max_nodes, spec.genome.max_connections))


def creature(task, seed):
    """A random genotype; networks have hidden nodes of every activation between the layers."""
    found = task.encoding.newcomer(key=jax.random.key(seed))
    return (
        with_hidden(found, task, np.random.default_rng(seed))
        if isinstance(found, CPPN)
        else found
    )


def controlled(task, genotype):
    """World, start and controller of a creature, from one program."""

    @jax.jit
    def develop(genotype):
        driven = drive(task, genotype, differentiable=True)
        return driven.world, driven.start, driven.controller

    return develop(genotype)


def with_hidden(network, task, rng):
    """Add a chain of nine hidden nodes, from an input through all activations to an output."""
    network = jax.tree.map(np.array, network)
    rows, links = len(network.bias), int(network.connection_used.sum())
    used = int(network.node_used.sum())
    inputs = task.encoding.controls.inputs
    hidden = used + np.arange(9)
    source, target = np.r_[0, hidden], np.r_[hidden, inputs]
    assert used + 9 <= rows
    assert links + 10 <= len(network.weight)
    fresh = links + np.arange(10)
    weight = rng.normal(0, 1.5, 10)
    cyclic = getattr(task.encoding, "recurrent", False)
    if cyclic:  # The last link leads back.
        target[-1] = hidden[3]
    network.node_used[hidden] = True
    network.node_id[hidden] = hidden
    network.activation[hidden] = np.arange(9)
    network.bias[hidden] = rng.normal(0, 1, 9)
    network.connection_used[fresh] = True
    network.innovation[fresh] = fresh
    network.source[fresh], network.target[fresh] = source, target
    network.enabled[fresh], network.enabled[1] = True, False
    network.weight[fresh] = weight
    return jax.tree.map(jnp.asarray, network)


@pytest.mark.long
@pytest.mark.parametrize("name", OPEN)
def test_the_kernel_develops_the_rest_shapes_of_jax(name):
    task = task_of(OPEN[name])

    @jax.jit
    def in_both(genotype):
        driven = drive(task, genotype, differentiable=True)
        found = native.develop(driven.world, driven.start, driven.controller)
        return driven.inputs, driven.clock, found

    for seed in (0, 1):
        inputs, timed, (rest, clock) = in_both(creature(task, seed))
        np.testing.assert_allclose(rest.angle, inputs.angle, rtol=0, atol=2e-5)
        np.testing.assert_allclose(rest.length, inputs.length, rtol=0, atol=2e-5)
        expected = np.arange(1.0, 201) if timed is None else timed
        np.testing.assert_allclose(clock, expected, rtol=0, atol=1e-3)


def test_a_phase_leads_the_timer():
    task = task_of({})

    @jax.jit
    def in_both(genotype, phase):
        driven = task.encoding.drive(task.world, task.start, genotype, phase)
        rest, _ = native.develop(driven.world, driven.start, driven.controller)
        return driven.inputs, rest

    inputs, rest = in_both(creature(task, 3), jnp.float32(1.0))
    np.testing.assert_allclose(rest.angle, inputs.angle, rtol=0, atol=1e-5)


def differing(controls):
    """Controls of three creatures: arrays with a row for each, and the first creature's own."""
    rng = np.random.default_rng(0)
    joints = len(controls.joint_nodes)
    rows = {
        "sites": rng.uniform(-1, 1, (3, *controls.sites.shape)),
        "wave": rng.uniform(0, 6, (3, controls.nodes)),
        "gain": rng.choice([-1.0, 0.5, 1.0], (3, joints)),
        "rest_angle": rng.uniform(-0.2, 0.2, (3, joints)),
        "rest_length": rng.uniform(0.8, 1.2, (3, len(controls.edges))),
    }
    graph = {
        "edges": np.stack([controls.edges, controls.edges[:, ::-1], controls.edges]),
        "joint_nodes": rng.integers(0, controls.nodes, (3, joints)),
    }
    rows = {name: values.astype(np.float32) for name, values in rows.items()}
    return rows | {name: values.astype(np.int32) for name, values in graph.items()}


@pytest.mark.long
@pytest.mark.parametrize("name", ["cppn", "recurrent"])
def test_controls_may_differ_between_creatures_of_a_batch(name):
    task = task_of(OPEN[name], steps=60)
    genotype, rows = creature(task, 2), differing(task.encoding.controls)

    def driven(row):
        controls = replace(task.encoding.controls, **row)
        encoding = replace(task.encoding, controls=controls)
        return encoding.drive(task.world, task.start, genotype, jnp.float32(0.4))

    @jax.jit
    @jax.vmap
    def in_both(row):
        found = driven(row)
        return found.inputs, native.develop(found.world, found.start, found.controller)[0]

    expected, found = in_both(jax.tree.map(jnp.asarray, rows))
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=2e-5), found, expected)
    for number in range(3):  # The arrays of NumPy are constants of a program.
        row = {name: values[number] for name, values in rows.items()}
        alone = jax.jit(lambda row=row: driven(row).inputs)()
        for one, all_ in zip(jax.tree.leaves(alone), jax.tree.leaves(expected), strict=True):
            np.testing.assert_allclose(all_[number], one, rtol=0, atol=2e-5)


@pytest.mark.long
@pytest.mark.parametrize("name", CLOSED)
def test_the_kernel_closes_the_loop_as_jax_does(name):
    consumed = {**ENERGY, "consume": True, "diffusion": 0.05}
    task = task_of(CLOSED[name], ENERGY if "without" in name else consumed)

    @jax.jit
    def in_both(genotype):
        driven = drive(task, genotype, differentiable=True)
        in_jax = world.rollout(
            driven.world, driven.start, driven.inputs, observe, driven.control, driven.remember
        )
        return in_jax, native.rollout(driven.world, driven.start, driven.controller)

    (end, seen), (found, observed) = jax.device_get(in_both(creature(task, 1)))
    for steps in (1, 10, 200):
        np.testing.assert_allclose(
            observed.rest.angle[:steps], seen.rest.angle[:steps], rtol=0, atol=1e-4
        )
        np.testing.assert_allclose(
            observed.positions[:steps], seen.positions[:steps], rtol=0, atol=1e-3
        )
    np.testing.assert_allclose(found.collected, end.collected, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("name", ["cppn", "layers", "series"])
def test_every_instruction_set_develops_the_same_bits(name):
    task = task_of(OPEN[name])
    given = controlled(task, creature(task, 0))
    found = [native.develop(*given, one) for one in kernels.instruction_sets()]
    for other in found[1:]:
        jax.tree.map(np.testing.assert_array_equal, other, found[0])


def test_every_instruction_set_closes_the_loop_with_the_same_bits():
    task = task_of(CLOSED["senses with memory"], ENERGY)
    given = controlled(task, creature(task, 0))
    found = [native.rollout(*given, one) for one in kernels.instruction_sets()]
    for other in found[1:]:
        jax.tree.map(np.testing.assert_array_equal, other, found[0])


def test_a_network_that_refers_to_rows_it_lacks_is_refused():
    task = task_of({})
    box, start, controller = controlled(task, creature(task, 0))
    commands = controller.commands
    wrong = jnp.full_like(commands.source, len(commands.bias))
    broken = replace(controller, commands=replace(commands, source=wrong))
    with pytest.raises(Exception, match="refers to what it lacks"):
        jax.block_until_ready(native.develop(box, start, broken))
