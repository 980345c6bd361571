"""Round bodies with straight filaments that stand off them."""

import numpy as np

from ... import bodies


def tufted(
    ring_nodes: int,
    roots: np.ndarray,
    hair_nodes: int,
    spacing: float,
    *,
    stretch: float,
    shear: float,
    bend: float,
) -> bodies.Body:
    """A ring, and from each of its nodes `roots` a hair outward.

    Nodes and edges of the ring come first, `ring_nodes` of both; those of each hair follow,
    from its root to its tip.
    """
    ring = bodies.ring(ring_nodes, spacing)
    base = ring.positions[roots]
    away = base / np.hypot(base[:, 0], base[:, 1])[:, None]
    along = spacing * np.arange(1, hair_nodes + 1)
    hairs = base[:, None] + along[None, :, None] * away[:, None]
    outer = ring_nodes + np.arange(len(roots) * hair_nodes).reshape(-1, hair_nodes)
    inner = np.concatenate([roots[:, None], outer[:, :-1]], 1)
    return bodies.from_edges(
        np.concatenate([ring.positions, hairs.reshape(-1, 2)]),
        np.concatenate([ring.edges, np.stack([inner.reshape(-1), outer.reshape(-1)], 1)]),
        stretch=stretch,
        shear=shear,
        bend=bend,
    )
