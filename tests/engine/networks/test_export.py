"""Genomes written for TensorNEAT keep our bound, and share one compiled program."""

import numpy as np
import pytest

from microcosmos import networks
from microcosmos.naming import ACTIVATIONS
from microcosmos.networks.network import Link, Network, Node


@pytest.mark.fast
@pytest.mark.parametrize("activation", ["identity", "relu", "abs", "square"])
def test_a_network_that_passes_the_bound_keeps_it_there_and_back(activation):
    """A chain of squares, then an activation of a sum of about −10⁸, and an output."""
    chain = [Node(2, 40.0, activation="square"), Node(3, activation="square")]
    last, output = Node(4, 0.5, activation=activation), Node(1, -0.25)
    links = (Link(0, 2, 1.0), Link(2, 3, 1.0), Link(3, 4, -100.0), Link(4, 1, 2.0))
    nodes = Node(0), output, *chain, last
    network = Network(1, (1,), nodes, links, rule="always", bound=1e6)
    written = networks.write_tensorneat(network)
    assert set(written.meta["register"]) > {"bounded_identity", "bounded_square"}
    genes = networks.to_genes(
        networks.read_tensorneat(written.nodes, written.conns, written.meta)
    )
    assert {"square", activation} <= set(genes["nodes"]["activation"]) <= set(ACTIVATIONS)
    again = networks.from_genes(genes, ["x"], ["y"])
    x = networks.probes(1)
    found = networks.evaluate(network, x)
    np.testing.assert_allclose(networks.evaluate(again, x), found, rtol=1e-6)
    reached = {"identity": -1e6, "relu": 0.0, "abs": 1e6, "square": 1e6}[activation]
    assert (found == np.clip(2 * reached - 0.25, -1e6, 1e6)).mean() > 0.9


@pytest.mark.fast
def test_all_genomes_have_the_same_list_of_activations(grown):
    lists = {
        tuple(networks.write_tensorneat(network).meta["activation_names"])
        for network in (
            networks.from_genes(genes, ("x", "y", "z"), ("u", "v")) for genes in grown[:20]
        )
    }
    assert len(lists) == 1
