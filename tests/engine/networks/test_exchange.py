"""Networks compute TensorNEAT's values; genes are exchanged with TensorNEAT."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, networks
from microcosmos.spec.creature.genomes import Connections, Nodes, check_genes

INPUTS, OUTPUTS = ("position", "sine", "cosine"), ("rest_angle", "rest_length")


def test_grown_genes_go_there_and_back_sound_and_with_the_same_values(grown):
    """Also those whose values pass the bound of ours, which TensorNEAT lacks."""
    bounded = 0
    for genes in grown:
        network = networks.from_genes(genes, INPUTS, OUTPUTS)
        inputs = networks.probes(3)
        expected = networks.evaluate(network, inputs)
        unbounded = networks.evaluate(replace(network, bound=np.inf), inputs)
        written = networks.write_tensorneat(network)
        back = networks.read_tensorneat(written.nodes, written.conns, written.meta)
        imported = networks.to_genes(back)
        if not networks.agree(expected, unbounded):
            bounded += 1
            assert any(node.activation.startswith("bounded") for node in back.nodes)
        check_genes(3, 2, Nodes(**imported["nodes"]), Connections(**imported["connections"]))
        again = networks.from_genes(imported, INPUTS, OUTPUTS)
        assert np.isfinite(expected).all()
        for other in (back, again):
            difference = np.abs(networks.evaluate(other, inputs) - expected)
            assert np.max(difference / np.maximum(1, np.abs(expected))) <= 1e-6
    assert bounded


def test_genes_without_disabled_connections_are_themselves_again(grown):
    for genes in grown[:200]:
        network = networks.from_genes(genes, INPUTS, OUTPUTS)
        once = networks.to_genes(network)
        assert networks.to_genes(networks.from_genes(once, INPUTS, OUTPUTS)) == once
        assert once["connections"]["innovation"] == [x.marker for x in network.links]


def test_a_genome_of_tensorneat_is_written_as_it_was_read(reference):
    for nodes, conns in zip(reference.nodes, reference.conns, strict=True):
        network = networks.read_tensorneat(nodes, conns, reference.meta)
        data = networks.dump_tensorneat(networks.write_tensorneat(network), 1.5)
        again, fitness = networks.load_tensorneat(data)
        assert fitness == 1.5
        assert again.steps == network.steps
        assert again.output_transform == network.output_transform
        markers, others = (
            {pair: link.marker for pair, link in zip(one.pairs, one.links, strict=True)}
            for one in (again, network)
        )
        assert markers == others


@pytest.mark.fast
def test_outputs_that_follow_hidden_keys_are_renumbered():
    """As TensorNEAT has them with `init_hidden_layers`: the outputs have the last keys."""
    nodes = np.array([[0, 0, 0, 0], [1, 0.5, 0, 1], [2, -1, 0, 0]], np.float32)
    conns = np.array([[0, 1, 2], [1, 2, 3]], np.float32)
    meta = described(1, 1, ["tanh", "sin"], output_keys=[2])
    genes = networks.to_genes(networks.read_tensorneat(nodes, conns, meta))
    assert genes["nodes"]["id"] == [0, 1, 2]
    assert genes["nodes"]["activation"] == ["identity", "identity", "sin"]
    assert genes["connections"]["source"] == [0, 2]
    assert genes["connections"]["target"] == [2, 1]


@pytest.mark.fast
def test_a_settled_recurrent_network_is_feed_forward():
    nodes = np.array([[0, 0, 0, 0], [1, -1, 0, 0], [2, 0.5, 0, 0]], np.float32)
    conns = np.array([[0, 2, 2], [2, 1, 3]], np.float32)
    meta = described(1, 1, ["sin"], genome_class="RecurrentGenome", activate_time=2)
    assert networks.to_genes(networks.read_tensorneat(nodes, conns, meta))
    with pytest.raises(ValueError, match="`steps` must be at least the depth 2, got 1"):
        networks.to_genes(networks.read_tensorneat(nodes, conns, meta | {"activate_time": 1}))


@pytest.mark.fast
@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"activation_names": ["exp"]}, "`activation` must be among .* got \\['exp'\\]"),
        ({"aggregation_names": ["max"]}, "`aggregation` must be sum, .* max of 2 at node 3"),
        ({"num_outputs": 2}, "`outputs` must be reached from an input, got \\[2\\]"),
    ],
)
def test_a_network_that_our_genes_cannot_express_is_refused(change, reason):
    nodes = np.array([[0, 0, 0, 0], [1, 0, 0, 0], [2, 1, 0, 0], [3, 1, 0, 0]], np.float32)
    conns = np.array([[0, 3, 2], [1, 3, 1], [3, 2, 3]], np.float32)
    if "num_outputs" in change:
        conns = conns[:2]
    meta = described(2, 1, ["sin"]) | change
    network = networks.read_tensorneat(nodes, conns, meta)
    with pytest.raises(ValueError, match=reason):
        networks.to_genes(network)


def described(inputs, outputs, activations, **more):
    return {
        "genome_class": "DefaultGenome",
        "node_class": "BiasNode",
        "conn_class": "DefaultConn",
        "activation_names": activations,
        "aggregation_names": ["sum"],
        "num_inputs": inputs,
        "num_outputs": outputs,
    } | more


NODES = [[0, 0, 0, 0], [1, 0, 0, 0], [2, 1, 0, 0], [9, 1, 0, 1]]
CONNS = [[0, 2, 1], [1, 9, 1], [9, 2, 1]]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("table", "place", "value", "reason"),
    [
        ("nodes", (3, 0), 2, "`keys` must differ, got 2"),
        ("nodes", (3, 0), 2**24, "key that is whole, from 0 to 16777215, got 1.67772e"),
        ("nodes", (3, 0), 8.5, "key that is whole, .* got 8.5"),
        ("nodes", (3, 0), -1, "key that is whole, .* got -1"),
        ("nodes", (3, 1), np.nan, "`nodes` must be finite in used rows"),
        ("nodes", (3, 2), 1, "function index \\(aggregation\\) .* from 0 to 0, got 1"),
        ("nodes", (3, 3), 2, "function index \\(activation\\) .* from -1 to 1, got 2"),
        ("nodes", (3, 3), 0.5, "function index \\(activation\\) .* got 0.5"),
        ("nodes", (1, 0), 5, "`nodes` must have the input or output 1 in row 1, got 5"),
        ("conns", (0, 0), 7, "connections must join existing nodes, got 7"),
        ("conns", (0, 1), 1, "`target` must not be an input, got 1"),
        ("conns", (0, 0), 9, "once, got twice \\(9, 2\\)"),
        ("conns", (0, 2), np.inf, "`conns` must be finite in used rows"),
        ("conns", (1, 0), 9, "must be free of cycles, got one that holds or leads to 2, 9"),
    ],
)
def test_a_malformed_genome_is_refused_with_field_need_and_what_came(
    table, place, value, reason
):
    tables = {"nodes": np.array(NODES, np.float32), "conns": np.array(CONNS, np.float32)}
    meta = described(2, 1, ["sin", "cos"])
    assert networks.read_tensorneat(**tables, meta=meta)
    tables[table][place] = value
    with pytest.raises(ValueError, match=reason):
        networks.read_tensorneat(**tables, meta=meta)


@pytest.mark.fast
def test_values_are_those_of_tensorneat_in_double_precision_nan_included(reference):
    for number, genome in enumerate(zip(reference.nodes, reference.conns, strict=True)):
        network = networks.read_tensorneat(*genome, reference.meta)
        for steps, outputs in reference.outputs.items():
            shorter = replace(network, steps=steps) if steps else network
            values = networks.evaluate(shorter, reference.inputs)
            np.testing.assert_array_equal(np.isnan(values), np.isnan(outputs[number]))
            scale = np.maximum(1, np.abs(outputs[number]))
            worst = np.max(np.nan_to_num(np.abs(values - outputs[number]) / scale))
            assert worst <= 1e-6


def test_the_engine_and_networks_agree_on_grown_genes(grown, float64):
    inputs = np.random.default_rng(0).uniform(-1, 1, (3, 9))
    some = [genomes.from_genes(genes, 64, 128) for genes in grown[:100]]
    for genes, values in zip(grown, computed(some, inputs), strict=False):
        own = networks.evaluate(networks.from_genes(genes, INPUTS, OUTPUTS), inputs)
        assert networks.agree(own, values)


def computed(cppns, inputs):
    """The engine's outputs (network, output, point) in double precision."""
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves), *cppns)
    genes = {name: getattr(batch, name).astype("float64") for name in ("bias", "weight")}
    batch = replace(batch, **genes)
    program = jax.jit(jax.vmap(lambda network, x: genomes.evaluate(network, x, 2), (0, None)))
    return np.asarray(program(batch, jnp.asarray(inputs)))


@pytest.mark.fast
def test_agreement_is_about_size_nan_and_infinity():
    values = np.array([0.0, 1e6, np.nan, np.inf])
    assert networks.agree(values, values + np.array([1e-6, 0.9, 0, 0]))
    assert not networks.agree(values, values + np.array([2e-6, 0, 0, 0]))
    assert not networks.agree(values, np.array([0.0, 1e6, np.nan, -np.inf]))
    assert not networks.agree(values, np.array([0.0, 1e6, 1.0, np.inf]))
    assert not networks.agree(values, np.array([np.nan, 1e6, np.nan, np.inf]))
