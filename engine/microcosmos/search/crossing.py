"""Filaments that pass through each other, which is impossible in a plane."""

from math import ceil

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ..archive.poses import LEVELS
from .window import Poses

MOST_PAIRS = 2**23
"""Most pairs of edges over all poses: of larger bodies only every second, third ... pose
counts."""
COARSER = 4
"""Recorded levels in a unit of place: products of differences then fit 32 bits, so signs are
exact."""


def crossing(shown: Poses, start: Float[Array, "node 2"]) -> Float[Array, ""]:
    """Return the share of recorded poses in which two edges cross that do not at the start."""
    size, frames = len(shown.edges), len(shown.positions)
    step = min(frames, ceil(frames * size**2 / MOST_PAIRS)) or 1
    pairs = _apart(shown) & ~_crossed(whole_units(start), shown.edges)
    positions = shown.positions[step - 1 :: step].astype(jnp.int32) // COARSER
    found = jax.lax.map(lambda at: jnp.any(_crossed(at, shown.edges) & pairs), positions)
    return jnp.mean(found.astype(shown.scale.dtype))


def _apart(shown: Poses) -> Bool[Array, "edge edge"]:
    """Return which pairs of edges are present and share no node; each pair once."""
    first, second = shown.edges.T
    shared = [
        one[:, None] == other[None] for one in (first, second) for other in (first, second)
    ]
    there = shown.present[first] & shown.present[second]
    once = jnp.asarray(np.tri(len(first), k=-1, dtype=bool))
    return once & there[:, None] & there[None] & ~jnp.any(jnp.stack(shared), 0)


def whole_units(points: Float[Array, "node 2"]) -> Int[Array, "node 2"]:
    """Return places about their mean in whole units, as fine as those of recorded poses."""
    middle = points - points.mean(0, keepdims=True)
    most = LEVELS // COARSER
    return jnp.rint(middle * (most / jnp.max(jnp.abs(middle)))).astype(jnp.int32)


def _crossed(at: Int[Array, "node 2"], edges: Int[Array, "edge 2"]) -> Bool[Array, "edge edge"]:
    """Return which edges lie across each other: the ends of each on both sides of the other."""
    base, tip = at[edges[:, 0]], at[edges[:, 1]]

    def side(points: Int[Array, "edge 2"]) -> Int[Array, "edge edge"]:
        """Return the sign of each point's side of each edge."""
        along, away = (tip - base)[:, None], points[None] - base[:, None]
        return jnp.sign(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])

    divides = side(base) * side(tip) < 0
    return divides & divides.T
