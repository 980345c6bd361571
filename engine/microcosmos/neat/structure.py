"""Structural mutations of a network, and the sets of nodes that keep it acyclic."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int, UInt32

from ..genomes import CPPN
from .rows import (
    NONE,
    Uniform,
    barrier,
    below,
    choose,
    connect,
    drop_connection,
    drop_node,
    loop_rows,
    put,
    ranked,
    rescaled,
)
from .settings import Rates, bounded, one_of

WORD = 32

Sets = tuple[UInt32[Array, "node"], ...]
"""A set of nodes for each node: node n is bit n % 32 of word n // 32."""


def neighbours(
    owner: Int[Array, "connection"],
    member: Int[Array, "connection"],
    used: Bool[Array, "connection"],
    nodes: int,
) -> Sets:
    """Return, for each node, the members of the connections that it owns."""
    owner, node = jnp.where(used, owner, nodes), jnp.arange(nodes)
    bit = jnp.uint32(1) << (member % WORD).astype(jnp.uint32)
    bits = [jnp.where(member // WORD == word, bit, 0) for word in range(_words(nodes))]

    def join(row, sets):
        owns = owner[row] == node
        return tuple(s | jnp.where(owns, b[row], 0) for s, b in zip(sets, bits, strict=True))

    return loop_rows(owner.shape[0], join, tuple(jnp.zeros(nodes, jnp.uint32) for _ in bits))


def closure(sets: Sets) -> Sets:
    """Return the nodes that each node reaches, and itself (Warshall, J. ACM 9, 11, 1962)."""
    nodes = sets[0].shape[0]
    sets = tuple(a | b for a, b in zip(sets, singletons(nodes), strict=True))
    # Node by node: nodes that reach this one reach what it reaches. Words are a tuple, whose
    # index must be fixed when the program is compiled, hence two loops.
    for word in range(len(sets)):
        first = word * WORD

        def through(bit, sets, word=word, first=first):
            reaches = (sets[word] >> jnp.uint32(bit)) & 1
            every = jnp.uint32(0) - reaches  # All bits where the node reaches this one.
            return tuple(s | (every & s[first + bit]) for s in sets)

        sets = jax.lax.fori_loop(0, min(WORD, nodes - first), through, sets)
    return sets


def singletons(nodes: int) -> Sets:
    """Return sets that hold each node itself."""
    node = jnp.arange(nodes)
    bit = jnp.uint32(1) << (node % WORD).astype(jnp.uint32)
    return tuple(jnp.where(node // WORD == word, bit, 0) for word in range(_words(nodes)))


def constant(among: Bool[Array, "node"]) -> Sets:
    """Return the same set for every node."""
    nodes = among.shape[0]
    bit = jnp.where(among, jnp.uint32(1) << (jnp.arange(nodes) % WORD).astype(jnp.uint32), 0)
    words = [
        jnp.sum(bit[w * WORD : (w + 1) * WORD], dtype=jnp.uint32) for w in range(_words(nodes))
    ]
    return tuple(jnp.broadcast_to(word, (nodes,)) for word in words)


def difference(one: Sets, other: Sets) -> Sets:
    return tuple(a & ~b for a, b in zip(one, other, strict=True))


def sizes(sets: Sets) -> Int[Array, "node"]:
    """Return the number of nodes in each set."""
    counts = jnp.stack([jax.lax.population_count(s) for s in sets])
    return jnp.sum(counts, 0, dtype=jnp.int32)


def flags(sets: Sets, node: Int[Array, ""]) -> Bool[Array, "node"]:
    """Return the set of one node as flags."""
    nodes = sets[0].shape[0]
    place = jnp.arange(nodes)
    words = jnp.stack([s[node] for s in sets])
    return ((words[place // WORD] >> (place % WORD).astype(jnp.uint32)) & 1).astype(bool)


def _words(nodes: int) -> int:
    return -(-nodes // WORD)


def add_connection(
    network: CPPN, happens: Bool[Array, ""], rates: Rates, inputs: int, uniform: Uniform
) -> tuple[CPPN, Int[Array, ""]]:
    """Join two unconnected nodes, by three draws; also return the new row, or −1."""
    if not rates.add_connection:
        return network, jnp.asarray(NONE)
    source, target, exists = barrier(_free_pair(network, rates, inputs, uniform))
    row = jnp.sum(network.connection_used)
    row = jnp.where(happens & exists & (row < network.connection_used.shape[0]), row, NONE)
    weight = bounded(rates.draw(uniform[2]), rates).astype(network.weight.dtype)
    return connect(network, row, source, target, weight), row


def add_node(
    network: CPPN,
    splittable: Bool[Array, "connection"],
    happens: Bool[Array, ""],
    rates: Rates,
    uniform: Uniform,
) -> tuple[CPPN, Int[Array, ""], Int[Array, ""], Int[Array, ""]]:
    """Split a connection, which is disabled or removed, by a new node, using two draws.

    The incoming connection has weight 1 and the outgoing one the old weight, so that a node
    with identity activation changes nothing. Also return the rows of the incoming connection
    and the node, and the number of the split connection, or −1 each.
    """
    old, exists = barrier(choose(splittable, uniform[0]))
    node, row = jnp.sum(network.node_used), jnp.sum(network.connection_used)
    row = row - rates.drop_split  # The split connection's row becomes free before.
    happens = happens & exists & (node < network.node_used.shape[0])
    happens = happens & (row + 1 < network.connection_used.shape[0])
    node_row, split_row = jnp.where(happens, node, NONE), jnp.where(happens, row, NONE)
    activation = one_of(rates.palette, uniform[1])
    one = jnp.ones((), network.weight.dtype)
    source, target, weight = network.source[old], network.target[old], network.weight[old]
    innovation = jnp.where(happens, network.innovation[old], NONE)
    network = replace(
        network,
        node_used=put(network.node_used, node_row, True),
        activation=put(network.activation, node_row, activation),
        enabled=put(network.enabled, jnp.where(happens, old, NONE), False),
    )
    if rates.drop_split:
        network = drop_connection(network, jnp.where(happens, old, NONE))
    network = connect(network, split_row, source, node, one)
    second = jnp.where(happens, row + 1, NONE)
    return connect(network, second, node, target, weight), split_row, node_row, innovation


def delete_connection(network: CPPN, rate: float, uniform: Uniform) -> CPPN:
    """Remove a connection."""
    row, exists = choose(network.connection_used, rescaled(uniform, 0.0, rate))
    return drop_connection(network, jnp.where((uniform < rate) & exists, row, NONE))


def delete_node(network: CPPN, rate: float, fixed: int, uniform: Uniform) -> CPPN:
    """Remove a hidden node and all its connections; the first `fixed` nodes stay."""
    hidden = network.node_used & (jnp.arange(network.node_used.shape[0]) >= fixed)
    node, exists = choose(hidden, rescaled(uniform, 0.0, rate))
    return drop_node(network, jnp.where((uniform < rate) & exists, node, NONE))


def _free_pair(
    network: CPPN, rates: Rates, inputs: int, uniform: Uniform
) -> tuple[Int[Array, ""], Int[Array, ""], Bool[Array, ""]]:
    """Draw source and target of a new connection; also return whether one is possible."""
    free = barrier(_free_sources(network, rates.recurrent))
    is_target = network.node_used & (jnp.arange(network.node_used.shape[0]) >= inputs)
    if rates.blind:
        source, _ = choose(network.node_used, uniform[0])
        target, exists = choose(is_target, uniform[1])
        return source, target, exists & flags(free, target)[source]
    # One draw among all possible pairs: its rank gives the target, the rest of it the source.
    many = jnp.where(is_target, sizes(free), 0)
    rank = below(jnp.sum(many), uniform[0])
    target = ranked(many, rank)
    before = jnp.sum(jnp.where(jnp.arange(len(many)) < target, many, 0))
    return ranked(flags(free, target), rank - before), target, jnp.any(many > 0)


def _free_sources(network: CPPN, recurrent: bool) -> Sets:
    """Return, for each node, the possible sources of a new connection."""
    used, nodes = network.connection_used, network.node_used.shape[0]
    joined = neighbours(network.target, network.source, used, nodes)
    free = difference(constant(network.node_used), joined)
    if recurrent:
        return free
    # A source that the target reaches, over connections enabled or not, would close a cycle.
    onward = neighbours(network.source, network.target, used, nodes)
    return difference(free, closure(onward))
