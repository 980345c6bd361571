"""Sweeps over many equal bodies in chunks that fit a near cache.

No constraint joins two bodies, so that each chunk can be swept on its own. Where all bodies
have the same graph, the first chunk's colours are those of every chunk.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int, PyTree

CHUNK = 2**11
"""Nodes in a chunk. Measured: chunks four times as large take 1.5 times as long per node."""


def first_chunk(
    member: Int[np.ndarray, "node"],
    edges: Int[np.ndarray, "edge 2"],
    joints: Int[np.ndarray, "joint 2"],
) -> tuple[int, int]:
    """Count the nodes and the edges in the first chunk of equal bodies; all if bodies differ.

    `member` is the body of each node, ascending from 0.
    """
    bodies = int(member[-1]) + 1
    chunk = max(1, CHUNK * bodies // len(member))
    nodes, links = len(member) // bodies, len(edges) // bodies
    alike = np.array_equal(member, np.repeat(np.arange(bodies), nodes))
    if chunk >= bodies or not alike:
        return len(member), len(edges)
    if not _repeat(edges, bodies, nodes) or not _repeat(joints, bodies, links):
        return len(member), len(edges)
    return chunk * nodes, chunk * links


def in_chunks(
    work: Callable[[PyTree], tuple[Array, ...]], given: PyTree[Array], nodes: int, chunk: int
) -> tuple[Array, ...]:
    """Apply `work` to arrays of equal bodies, `chunk` of the `nodes` at a time.

    `work` takes one chunk's rows of each array, padded with zeros after the last body, and
    returns new rows of the first arrays.
    """
    chunks = -(-nodes // chunk)

    def split(x):
        # Joints and edges are not as many as nodes: each array has its own rows in a chunk.
        rows = len(x) * chunk // nodes
        filled = jnp.pad(x, [(0, chunks * rows - len(x))] + [(0, 0)] * (x.ndim - 1))
        return filled.reshape(chunks, rows, *x.shape[1:])

    results = jax.lax.map(work, jax.tree.map(split, given))
    # `work` returns fewer arrays than it takes; rows that fill up the last chunk are cut off.
    return tuple(
        x.reshape(-1, *x.shape[2:])[: len(like)]
        for x, like in zip(results, given, strict=False)
    )


def _repeat(pairs: np.ndarray, bodies: int, members: int) -> bool:
    """Return whether every body has the same pairs of its own members."""
    if len(pairs) % bodies:
        return False
    relative = pairs.reshape(bodies, -1, 2) - members * np.arange(bodies)[:, None, None]
    return bool(np.all(relative == relative[:1]))
