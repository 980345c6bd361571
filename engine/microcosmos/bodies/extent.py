"""Extents of bodies: their reach along edges, and whether they fit into a world."""

import numpy as np

from .graph import Body
from .shape import distances

SUPPORT = 4
"""Width of the four-point delta in cells: the room between a creature and its image."""


def extent(body: Body) -> float:
    """Return the longest path along edges between two nodes, in cells.

    The path is found from the node farthest from the first node: exact without loops, and for
    one loop, of which the shorter way counts.
    """
    farthest, _ = _farthest(body, 0)
    return _farthest(body, farthest)[1]


def _farthest(body: Body, start: int) -> tuple[int, float]:
    """Return the node farthest from `start` along edges, and its distance."""
    way = distances(len(body.positions), body.edges, body.rest_length, start)
    way[np.isinf(way)] = -1.0
    last = int(np.argmax(way))
    return last, float(way[last])


def refuse_outside(body: Body, width: int | float, height: int | float) -> None:
    """Raise `ValueError` where a node lies outside the box, or a creature meets its image."""
    size = np.array([width, height], float)
    box = f"a world of {width:g} by {height:g} cells"
    outside = ((body.positions < 0) | (body.positions > size[None])).any(1)
    if outside.any():
        node = np.argmax(outside)
        x, y = body.positions[node]
        raise ValueError(f"`positions` must lie in {box}, node {node} is at {x:.4g}, {y:.4g}.")
    starts = np.flatnonzero(np.diff(body.member, prepend=-1))
    highest = np.maximum.reduceat(body.positions, starts)
    size_of_each = highest - np.minimum.reduceat(body.positions, starts)
    wide = (size_of_each > size[None] - SUPPORT).any(1)
    if wide.any():
        x, y = size_of_each[np.argmax(wide)]
        raise ValueError(
            f"`positions` must leave {SUPPORT} cells between a creature and its image in "
            f"{box}, creature {np.argmax(wide)} is {x:.4g} by {y:.4g}."
        )
