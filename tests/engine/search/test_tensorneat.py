"""TensorNEAT as a backend: refused where it is missing, else exact."""

import importlib.util
import json
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat
from microcosmos.search import tensorneat
from microcosmos.search.tensorneat_genomes import cppns
from microcosmos.viz import networks

needs_package = pytest.mark.skipif(
    not tensorneat.available(), reason="tensorneat is not installed: make tensorneat"
)

PRESET = neat.PRESETS["tensorneat"]
SETTINGS = replace(
    PRESET,
    population=40,
    rates=replace(PRESET.rates, palette=tuple(range(9)), add_node=0.5, activation=0.3),
)


@pytest.fixture(scope="module")
def backend():
    return tensorneat.build(SETTINGS, inputs=3, outputs=2, max_nodes=24, max_connections=48)


@pytest.fixture(scope="module")
def grown(backend):
    """A state after some generations, and the one after the first half of them."""
    state = half = backend.setup(7)
    for generation in range(8):
        half = state if generation == 4 else half
        state = backend.tell(state, invented(generation))
    return half, state


def invented(generation):
    fitness = np.random.default_rng(generation).normal(size=40)
    fitness[generation] = np.nan
    return fitness


@pytest.mark.fast
def test_without_the_package_the_refusal_names_the_command(monkeypatch):
    # The package is not loaded to look for it.
    assert tensorneat.available() == (importlib.util.find_spec("tensorneat") is not None)
    monkeypatch.setattr(tensorneat, "find_spec", lambda name: None)
    assert not tensorneat.available()
    with pytest.raises(ValueError, match=r"not installed; install it with: make tensorneat$"):
        tensorneat.build(SETTINGS, 3, 2, 24, 48)


@needs_package
def test_a_state_in_arrays_goes_on_bit_for_bit(backend, grown):
    half, end = grown
    arrays = backend.to_arrays(half)
    needed = {"randkey", "pop_nodes", "pop_conns", "generation", "species.center_nodes"}
    assert needed <= {*arrays}
    assert all(array.dtype != object for array in arrays.values())
    state = backend.from_arrays({name: array.copy() for name, array in arrays.items()})
    for generation in range(4, 8):
        state = backend.tell(state, invented(generation))
    expected = backend.to_arrays(end)
    for name, array in backend.to_arrays(state).items():
        np.testing.assert_array_equal(array, expected[name])


@needs_package
def test_the_population_computes_the_same_as_our_networks(backend, grown):
    """TensorNEAT's own forward, the engine, and our evaluation in double precision."""
    state = grown[1]
    inputs = np.random.default_rng(0).normal(size=(3, 32)).astype(np.float32)
    nodes, connections = backend.ask(state)
    outputs = forward(backend.algorithm, state)(nodes, connections, inputs.T)
    batch, computes = backend.population(state)
    evaluate = jax.jit(jax.vmap(lambda one: genomes.evaluate(one, jnp.asarray(inputs), 2)))
    ours = evaluate(jax.tree.map(jnp.asarray, batch))
    for row in range(40):
        theirs = np.asarray(outputs[row]).T
        network = networks.read_tensorneat(nodes[row], connections[row], backend.meta)
        own = networks.evaluate(network, inputs)
        assert networks.agree(own, theirs.astype(float), 1e-4)
        assert computes[row] == np.isfinite(theirs).all()
        if computes[row]:
            assert networks.agree(own, np.asarray(ours[row], float), 1e-4)
    assert computes.sum() > 20
    assert batch.node_used.sum(1).max() > 5


@needs_package
def test_exported_genes_run_in_tensorneat(backend, grown):
    """Genes of ours, written as a genome, in a population of TensorNEAT's."""
    state = grown[1]
    batch, computes = backend.population(state)
    inputs = np.random.default_rng(0).normal(size=(3, 16)).astype(np.float32)
    names = ("a", "b", "c"), ("d", "e")
    for row in np.flatnonzero(computes)[:5]:
        genes = genomes.to_genes(genomes.take(batch, int(row)))
        network = networks.from_genes(genes, *names)
        written = networks.write_tensorneat(network, 24, 48)
        names_of = list(genomes.ACTIVATIONS)
        palette = tuple(names_of.index(name) for name in written.meta["activation_names"])
        rates = replace(SETTINGS.rates, palette=palette)
        own = tensorneat.build(replace(SETTINGS, rates=rates), 3, 2, 24, 48).algorithm
        genome = jax.tree.map(jnp.asarray, (written.nodes, written.conns))
        theirs = forward(own, state)(genome[0][None], genome[1][None], inputs.T)[0]
        expected = networks.evaluate(network, inputs)
        assert networks.agree(expected, np.asarray(theirs, float).T, 1e-4)


def forward(algorithm, state):
    """TensorNEAT's outputs (genome, point, output)."""

    def one(nodes, connections, inputs):
        transformed = algorithm.transform(state, (nodes, connections))
        return jax.vmap(lambda x: algorithm.forward(state, transformed, x))(inputs)

    return jax.jit(jax.vmap(one, (0, 0, None)))


FILE = Path(__file__).parents[1] / "viz" / "networks" / "tensorneat" / "ff_bias.npz"


def test_all_at_once_equals_one_by_one():
    with np.load(FILE) as file:
        nodes, links, meta = file["nodes"], file["conns"], json.loads(str(file["meta"]))
    batch, computes = cppns(nodes, links, meta["activation_names"], 4, 2)
    assert 300 < computes.sum() < 400
    for row in range(len(nodes)):
        network = networks.read_tensorneat(nodes[row], links[row], meta)
        found = genomes.take(batch, row)
        if not computes[row]:
            with pytest.raises(ValueError, match="`outputs` must be reached from an input"):
                networks.to_genes(network, check=False)
            assert found.node_used.sum() == 6
            assert not found.connection_used.any()
            continue
        expected = genomes.from_genes(networks.to_genes(network, check=False), 30, 60)
        for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
            np.testing.assert_array_equal(one, other)
            assert one.dtype == other.dtype
