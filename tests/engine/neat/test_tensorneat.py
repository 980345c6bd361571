"""The preset `tensorneat` varies networks as often and as much as TensorNEAT does.

The numbers are those of TensorNEAT itself. What must differ: ours deletes before it adds, so
a new node is never lost at once (TensorNEAT gains one in 0.09, ours in 0.1) and a link that
was just deleted may come again; biases of inputs do not exist; there is no response.
"""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat

INPUTS, OUTPUTS, TRIALS = 4, 2, 20_000
FIGURES = json.loads((Path(__file__).parent / "tensorneat_operators.json").read_text())
PRESET = neat.PRESETS["tensorneat"]


@jax.jit
def vary(parent, keys):
    mutate = jax.vmap(lambda k: neat.mutate(parent, PRESET.rates, INPUTS, OUTPUTS, key=k))
    return mutate(keys)


@pytest.fixture(scope="module", params=["initial", "evolved"])
def mutated(request):
    """The figures, the parent, and many independent children of it."""
    figures = FIGURES[request.param]
    parent = genomes.empty(16, 32)
    row_of = {key: row for row, (key, _) in enumerate(figures["nodes"])}
    for row, (key, bias) in enumerate(figures["nodes"]):
        parent.node_used[row], parent.node_id[row], parent.bias[row] = True, key, bias
    for row, (source, target, weight) in enumerate(figures["connections"]):
        parent.connection_used[row] = parent.enabled[row] = True
        parent.innovation[row], parent.weight[row] = row, weight
        parent.source[row], parent.target[row] = row_of[source], row_of[target]
    keys = jax.random.split(jax.random.key(0), TRIALS)
    children, novelty = jax.device_get(vary(jax.tree.map(jnp.asarray, parent), keys))
    return figures, parent, children, novelty


def spread(share):
    """Four standard deviations of the difference of two such shares."""
    return 4 * np.sqrt(2 * max(share * (1 - share), 1e-4) / TRIALS)


def test_structure_changes_as_often(mutated):
    figures, parent, children, novelty = mutated
    split = novelty.node_row >= 0
    lost_node = children.node_used.sum(1) - split < parent.node_used.sum()
    gained = novelty.connection_row >= 0
    assert split.mean() == pytest.approx(PRESET.rates.add_node, abs=spread(0.1))
    # A node that was split in is deleted again with probability 0.1 / (hidden + 1).
    hidden = parent.node_used.sum() - INPUTS - OUTPUTS
    kept = split.mean() * (1 - 0.1 / (hidden + 1))
    assert kept == pytest.approx(figures["fraction_gain_node"], abs=spread(0.1))
    assert lost_node.mean() == pytest.approx(figures["fraction_lose_node"], abs=spread(0.1))
    theirs = figures["fraction_gain_conn_between_old_nodes"]
    assert gained.mean() == pytest.approx(theirs, abs=0.015)
    whole = ~lost_node
    size = children.connection_used.sum(1) - split - gained
    lost = (size < parent.connection_used.sum())[whole].mean()
    theirs = figures["fraction_lose_conn_between_surviving_nodes_net_of_split"]
    assert lost == pytest.approx(theirs, abs=spread(0.2))
