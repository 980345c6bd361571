"""Structural mutations: adding and removing connections and nodes."""

from dataclasses import replace

import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from ..genomes import CPPN
from . import acyclicity
from .rates import Rates, bounded, one_of
from .rng import Uniform, below, rescaled
from .rows import NONE, barrier, choose, connect, drop_connection, drop_node, put, ranked


def add_connection(
    network: CPPN, happens: Bool[Array, ""], rates: Rates, inputs: int, uniform: Uniform
) -> tuple[CPPN, Int[Array, ""]]:
    """Join two unconnected nodes, using three draws; also return the new row, or −1."""
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
    row = row - rates.drop_split
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
        return source, target, exists & acyclicity.flags(free, target)[source]
    many = jnp.where(is_target, acyclicity.sizes(free), 0)
    rank = below(jnp.sum(many), uniform[0])
    target = ranked(many, rank)
    before = jnp.sum(jnp.where(jnp.arange(len(many)) < target, many, 0))
    return ranked(acyclicity.flags(free, target), rank - before), target, jnp.any(many > 0)


def _free_sources(network: CPPN, recurrent: bool) -> acyclicity.Sets:
    """Return, for each node, the possible sources of a new connection."""
    used, nodes = network.connection_used, network.node_used.shape[0]
    joined = acyclicity.neighbours(network.target, network.source, used, nodes)
    free = acyclicity.difference(acyclicity.constant(network.node_used), joined)
    if recurrent:
        return free
    onward = acyclicity.neighbours(network.source, network.target, used, nodes)
    return acyclicity.difference(free, acyclicity.closure(onward))
