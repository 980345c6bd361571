"""Rows of genes: written, chosen, removed and found by number."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int, PRNGKeyArray

from ..genomes import CPPN

NONE = -1
"""Stands for the row or the number of a gene that is not there."""

NODES = ("node_used", "node_id", "activation", "bias")
CONNECTIONS = ("connection_used", "innovation", "source", "target", "enabled", "weight")


def put(values: Array, row: Int[Array, ""], value) -> Array:
    """The values with one replaced, or as they were where `row` is −1."""
    return jnp.where(jnp.arange(values.shape[0]) == row, value, values)


def connect(network: CPPN, row, source, target, weight) -> CPPN:
    """The network with a connection in a free row, or as it was where `row` is −1."""
    return replace(
        network,
        connection_used=put(network.connection_used, row, True),
        source=put(network.source, row, source),
        target=put(network.target, row, target),
        enabled=put(network.enabled, row, True),
        weight=put(network.weight, row, weight),
    )


def choose(
    allowed: Bool[Array, "item"], *, key: PRNGKeyArray
) -> tuple[Int[Array, ""], Bool[Array, ""]]:
    """One allowed item, each equally likely, and whether there is any."""
    total = jnp.sum(allowed)
    return ranked(allowed, draw_below(total, key=key)), total > 0


def ranked(weights: Array, rank: Int[Array, ""]) -> Int[Array, ""]:
    """The item that holds the place `rank` where each takes as many as its weight."""
    place = jnp.sum(jnp.cumsum(weights.astype(jnp.int32)) <= rank)
    return jnp.minimum(place, weights.shape[0] - 1)


def draw_below(total: Int[Array, ""], *, key: PRNGKeyArray) -> Int[Array, ""]:
    """A whole number from 0 on below `total`, or 0 where that is 0."""
    limit = jnp.maximum(1, total).astype(jnp.uint32)
    return (jax.random.bits(key) % limit).astype(jnp.int32)


def match(
    numbers: Int[Array, "gene"],
    used: Bool[Array, "gene"],
    others: Int[Array, "other"],
    others_used: Bool[Array, "other"],
) -> Int[Array, "gene"]:
    """The row of the other parent's gene that has the same number, or −1.

    Numbers increase along the used rows, which come first.
    """
    table = jnp.where(others_used, others, jnp.iinfo(others.dtype).max)
    row = jnp.searchsorted(table, numbers, method="scan_unrolled")
    row = jnp.minimum(row, table.shape[0] - 1)
    row = jnp.where(used & (table[row] == numbers), row, NONE)
    return jax.lax.optimization_barrier(row)  # XLA would search again for each use.


def drop_connection(network: CPPN, row: Int[Array, ""]) -> CPPN:
    """The network without one connection gene, the later ones moved up; −1 for none."""
    place = jnp.arange(network.weight.shape[0])
    return _moved(network, CONNECTIONS, _step(place, row))


def drop_node(network: CPPN, node: Int[Array, ""]) -> CPPN:
    """The network without one node and all its connections; −1 for none."""
    kept = network.connection_used & (network.source != node) & (network.target != node)
    rows = jnp.arange(kept.shape[0])
    order = jnp.searchsorted(jnp.cumsum(kept), rows + 1, method="scan_unrolled")
    network = _moved(network, CONNECTIONS, order)
    earlier = (node >= 0) & (network.source > node), (node >= 0) & (network.target > node)
    network = replace(
        network, source=network.source - earlier[0], target=network.target - earlier[1]
    )
    place = jnp.arange(network.node_used.shape[0])
    return _moved(network, NODES, _step(place, node))


def _step(place, row):
    """Where each row is filled from once `row` is gone."""
    return place + ((row >= 0) & (place >= row))


def _moved(network: CPPN, names: tuple[str, ...], origin) -> CPPN:
    """The named columns filled from the rows of `origin`, with zeros from beyond the end."""
    columns = {
        n: jnp.take(getattr(network, n), origin, mode="fill", fill_value=0) for n in names
    }
    return replace(network, **columns)
