"""Rows of genes: add, choose, match and remove them."""

from collections.abc import Callable
from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from ..genomes import CPPN
from .rng import Uniform, below

NONE = -1
"""Row or number of an absent gene."""

UNROLLED = 10

NODES = ("node_used", "node_id", "activation", "bias")
CONNECTIONS = ("connection_used", "innovation", "source", "target", "enabled", "weight")


def put(values: Array, row: Int[Array, ""], value) -> Array:
    """Replace one value; none where `row` is −1."""
    return jnp.where(jnp.arange(values.shape[0]) == row, value, values)


def connect(network: CPPN, row, source, target, weight) -> CPPN:
    """Add a connection in a free row; none where `row` is −1."""
    return replace(
        network,
        connection_used=put(network.connection_used, row, True),
        source=put(network.source, row, source),
        target=put(network.target, row, target),
        enabled=put(network.enabled, row, True),
        weight=put(network.weight, row, weight),
    )


def choose(
    allowed: Bool[Array, "item"], uniform: Uniform
) -> tuple[Int[Array, ""], Bool[Array, ""]]:
    """Draw one allowed item uniformly; also return whether there is any."""
    total = jnp.sum(allowed)
    return ranked(allowed, below(total, uniform)), total > 0


def ranked(weights: Array, rank: Int[Array, ""]) -> Int[Array, ""]:
    """Return the item at `rank` where each item counts as often as its weight."""
    place = jnp.sum(jnp.cumsum(weights.astype(jnp.int32)) <= rank)
    return jnp.minimum(place, weights.shape[0] - 1)


def match(
    numbers: Int[Array, "gene"],
    used: Bool[Array, "gene"],
    others: Int[Array, "other"],
    others_used: Bool[Array, "other"],
) -> Int[Array, "gene"]:
    """Return the row of the other parent's gene with the same number, or −1."""
    table = jnp.where(others_used, others, NONE)

    def compare(place, row):
        return jnp.where(table[place] == numbers, place, row)

    row = loop_rows(others.shape[0], compare, jnp.full(numbers.shape, NONE))
    return jnp.where(used, row, NONE)


def barrier(values):
    """Return the same values; XLA compiles their producers and consumers apart, faster."""
    return jax.lax.optimization_barrier(values)


def loop_rows(count: int, body: Callable, initial):
    """Loop over rows, unrolled: XLA makes one fast pass over a batch per iteration."""
    return jax.lax.fori_loop(0, count, body, initial, unroll=min(UNROLLED, count))


def drop_connection(network: CPPN, row: Int[Array, ""]) -> CPPN:
    """Remove one connection gene and move later ones up; −1 for none."""
    return _shifted(network, CONNECTIONS, row)


def drop_node(network: CPPN, node: Int[Array, ""]) -> CPPN:
    """Remove one node and all its connections; −1 for none."""
    kept = network.connection_used & (network.source != node) & (network.target != node)
    rows, upto = jnp.arange(kept.shape[0]), jnp.cumsum(kept)
    start = jnp.zeros(rows.shape, rows.dtype)
    order = loop_rows(kept.shape[0], lambda place, order: order + (upto[place] <= rows), start)
    columns = {
        n: jnp.take(getattr(network, n), order, mode="fill", fill_value=0) for n in CONNECTIONS
    }
    for end in ("source", "target"):
        columns[end] = columns[end] - ((node >= 0) & (columns[end] > node))
    return _shifted(replace(network, **columns), NODES, node)


def _shifted(network: CPPN, names: tuple[str, ...], row: Int[Array, ""]) -> CPPN:
    """Remove one row of the named columns, with zero at the end."""

    def shift(values):
        place = jnp.arange(values.shape[0])
        moved = jnp.append(values[1:], jnp.zeros((1,), values.dtype))
        return jnp.where((row >= 0) & (place >= row), moved, values)

    return replace(network, **{name: shift(getattr(network, name)) for name in names})
