"""Networks grow by NEAT's mutations and stay sound."""

from dataclasses import replace
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat

INPUTS, OUTPUTS, NODES, CONNECTIONS, BATCH = 3, 2, 12, 30, 32


@pytest.fixture(scope="module")
def lineages(mutated):
    return [networks for networks, *_ in mutated]


def test_networks_grow_to_fill_their_room_and_lose_no_genes(lineages):
    last = lineages[-1]
    assert last.node_used.sum(1).max() == NODES
    assert last.connection_used.sum(1).max() == CONNECTIONS
    for before, after in pairwise(lineages):
        kept = before.connection_used
        assert (after.innovation[kept] == before.innovation[kept]).all()
        assert (after.connection_used | ~kept).all()


def test_the_same_mutation_in_one_generation_gets_the_same_numbers(vary):
    parent = neat.minimal(jax.random.key(3), INPUTS, OUTPUTS, NODES, CONNECTIONS)
    parents = jax.tree.map(lambda x: jnp.broadcast_to(x, (BATCH, *x.shape)), parent)
    first = neat.first_counters(INPUTS, OUTPUTS)
    children, counters = vary(parents, first, jax.random.key(4))
    arose = np.asarray(children.node_id[:, INPUTS + OUTPUTS])
    arose = arose[arose > 0]
    # Thirty-two children of one parent can split six connections in six ways only.
    assert len(arose) > 6
    assert len(set(arose)) <= 6
    assert counters.node == arose.max() + 1


def test_a_split_by_the_identity_changes_nothing():
    rates = neat.Rates(0.0, 1.0, 0.0, 0.0, 0.0, add_node=1.0, add_connection=0.0)
    parent = neat.minimal(jax.random.key(5), INPUTS, OUTPUTS, NODES, CONNECTIONS)
    program = jax.jit(lambda n, k: neat.mutate(n, rates, INPUTS, key=k))
    child, novelty = program(parent, jax.random.key(6))
    identity = child.activation.at[novelty.node_row].set(0)
    child = replace(child, activation=identity)
    inputs = jax.random.normal(jax.random.key(7), (INPUTS, 50))
    assert child.node_used.sum() == parent.node_used.sum() + 1
    values = (genomes.evaluate(network, inputs, OUTPUTS) for network in (child, parent))
    np.testing.assert_allclose(*values, rtol=1e-5, atol=1e-6)


def test_recurrent_networks_may_hold_cycles_and_loops(lineages, each):
    growth = {"add_node": 0.3, "add_connection": 1.0, "recurrent": True}
    rates = neat.Rates(0.0, 1.0, 0.0, 0.0, 0.0, **growth)
    counters = neat.first_counters(INPUTS, OUTPUTS)
    networks = jax.tree.map(jnp.asarray, lineages[0])
    mutate = jax.jit(jax.vmap(lambda n, k: neat.mutate(n, rates, INPUTS, key=k)))
    numbered = jax.jit(neat.number)
    for step in range(12):
        children, novelty = mutate(networks, jax.random.split(jax.random.key(step), BATCH))
        networks, counters = numbered(children, novelty, counters)
    networks = jax.device_get(networks)
    used = networks.connection_used
    assert (networks.source == networks.target)[used].any()
    assert (networks.source > networks.target)[used].any()
    assert (networks.target[used] >= INPUTS).all()
    for network in each(networks):
        c = network.connection_used.sum()
        assert len(set(zip(network.source[:c], network.target[:c], strict=True))) == c
