"""Acyclic additions: reachability of nodes, as sets in 32-bit words."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int, UInt32

from .rows import loop_rows

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
