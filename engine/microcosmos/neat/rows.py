"""Rows of genes (add, choose, match, remove), and random numbers, all drawn at once.

Separate draws for each decision would take most of a generation's time. So a key gives two
words, and pcg3d hashes them with each index (Jarzynski and Olano, J. Comput. Graph. Tech. 9(3),
20, 2020).
"""

import math
from collections.abc import Callable
from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray, UInt32

from ..genomes import CPPN

Uniform = Float[Array, "..."]
"""Numbers in [0, 1), multiples of 2⁻²⁴."""

LARGEST = 1 - 2.0**-24


def draws(*shapes: tuple[int, ...], key: PRNGKeyArray) -> list[Uniform]:
    """Draw independent numbers, one array per shape."""
    ends, end = [], 0
    for shape in shapes:
        end += math.prod(shape)
        ends.append(end)
    words = jax.random.bits(key, (2,), "uint32")
    hashed = pcg3d(words[0], words[1], jnp.arange(end, dtype=jnp.uint32))
    # The upper 24 bits, as many as a float32 holds exactly: no draw rounds up to 1.
    uniform = (hashed >> 8).astype(jnp.float32) * 2.0**-24
    parts = jnp.split(uniform, ends[:-1])
    return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]


def pcg3d(x: UInt32[Array, ""], y: UInt32[Array, ""], z: UInt32[Array, "place"]):
    """Return the third word of the hash of three words."""
    x, y, z = (jnp.uint32(1664525) * word + jnp.uint32(1013904223) for word in (x, y, z))
    x, y, z = _mixed(x, y, z)
    return _mixed(*(word ^ (word >> 16) for word in (x, y, z)))[2]


def rescaled(uniform: Uniform, low: float, high: float) -> Uniform:
    """Map a draw that fell between two thresholds to a new draw in [0, 1)."""
    return jnp.clip((uniform - low) / max(high - low, 2.0**-24), 0, LARGEST)


def below(total: Int[Array, "..."], uniform: Uniform) -> Int[Array, "..."]:
    """Return a whole number in [0, `total`), or 0 where `total` is 0."""
    # In float32 the product may round up to `total`.
    most = jnp.maximum(0, total - 1)
    return jnp.minimum(jnp.floor(uniform * total).astype(most.dtype), most)


def _mixed(x, y, z):
    x = x + y * z
    y = y + z * x
    return x, y, z + x * y


NONE = -1
"""Row or number of an absent gene."""

UNROLLED = 10
"""Rows in an iteration of `loop_rows`."""

NODES = ("node_used", "node_id", "activation", "bias")
CONNECTIONS = ("connection_used", "innovation", "source", "target", "enabled", "weight")


def put(values: Array, row: Int[Array, ""], value) -> Array:
    """Replace the value in a row; −1 replaces none."""
    # A comparison with all rows becomes vectors over a batch; on a CPU XLA's scatter does not.
    return jnp.where(jnp.arange(values.shape[0]) == row, value, values)


def connect(network: CPPN, row, source, target, weight) -> CPPN:
    """Add a connection in a free row; `row` −1 adds none."""
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
    """Return the item at `rank` in a list that repeats each item as often as its weight."""
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
    """Return the same values, so that XLA compiles their producers and consumers apart."""
    # Fused into one program, the many small operations on genes take longer.
    return jax.lax.optimization_barrier(values)


def loop_rows(count: int, body: Callable, initial):
    """Loop over rows, `UNROLLED` at a time: XLA makes one pass over a batch per iteration."""
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
