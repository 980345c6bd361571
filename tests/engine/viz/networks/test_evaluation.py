"""Networks compute what TensorNEAT computes, and what the engine does."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes
from microcosmos.viz import networks

INPUTS, OUTPUTS = ("position", "sine", "cosine"), ("rest_angle", "rest_length")


@pytest.mark.fast
def test_values_are_those_of_tensorneat_in_double_precision_nan_included(reference):
    for number in range(len(reference)):
        network = networks.read_tensorneat(
            reference.nodes[number], reference.conns[number], reference.meta
        )
        for steps, outputs in reference.outputs.items():
            shorter = replace(network, steps=steps) if steps else network
            values = networks.evaluate(shorter, reference.inputs)
            np.testing.assert_array_equal(np.isnan(values), np.isnan(outputs[number]))
            scale = np.maximum(1, np.abs(outputs[number]))
            worst = np.max(np.nan_to_num(np.abs(values - outputs[number]) / scale))
            assert worst <= 1e-6


def test_the_engine_computes_the_same_for_every_genome_that_ours_can_express(
    reference, float64
):
    found = []
    for nodes, conns, expected in zip(
        reference.nodes, reference.conns, reference.outputs[None], strict=True
    ):
        genes = expressed(networks.read_tensorneat(nodes, conns, reference.meta))
        if genes is not None:
            found.append((genomes.from_genes(genes, 40, 80), expected))
    values = computed([cppn for cppn, _ in found], reference.inputs)
    expected = np.stack([outputs for _, outputs in found])
    assert np.max(np.abs(values - expected) / np.maximum(1, np.abs(expected))) <= 1e-6
    assert np.isfinite(expected).all()
    assert len(found) >= 8


def test_the_engine_and_networks_agree_on_grown_genes(grown, float64):
    inputs = np.random.default_rng(0).uniform(-1, 1, (3, 9))
    some = [genomes.from_genes(genes, 64, 128) for genes in grown[:100]]
    for genes, values in zip(grown, computed(some, inputs), strict=False):
        own = networks.evaluate(networks.from_genes(genes, INPUTS, OUTPUTS), inputs)
        assert networks.agree(own, values)


def expressed(network):
    """The genes, or None where ours cannot express the network."""
    try:
        return networks.to_genes(network)
    except ValueError:
        return None


def computed(cppns, inputs):
    """The engine's outputs (network, output, point) in double precision."""
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves), *cppns)
    batch = replace(
        batch, bias=batch.bias.astype("float64"), weight=batch.weight.astype("float64")
    )
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
