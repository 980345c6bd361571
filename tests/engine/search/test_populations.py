"""A population of genomes becomes the networks that its genomes one by one become."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest

from microcosmos import genomes
from microcosmos.search.populations import cppns
from microcosmos.viz import networks

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
