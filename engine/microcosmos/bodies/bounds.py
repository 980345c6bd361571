"""Whether creatures fit into their world."""

import numpy as np

from .graph import Body

SUPPORT = 4
"""Cells that a delta covers: the room between a creature and its periodic image."""


def refuse_outside(body: Body, width: int | float, height: int | float) -> None:
    """Raise where a node is outside the box, or a creature so large that it meets itself."""
    size = np.array([width, height], float)
    box = f"a world of {width:g} by {height:g} cells"
    outside = ((body.positions < 0) | (body.positions > size[None])).any(1)
    if outside.any():
        node = np.argmax(outside)
        x, y = body.positions[node]
        raise ValueError(f"`positions` must lie in {box}, node {node} is at {x:.4g}, {y:.4g}.")
    starts = np.flatnonzero(np.diff(body.member, prepend=-1))
    highest = np.maximum.reduceat(body.positions, starts)
    extent = highest - np.minimum.reduceat(body.positions, starts)
    wide = (extent > size[None] - SUPPORT).any(1)
    if wide.any():
        x, y = extent[np.argmax(wide)]
        raise ValueError(
            f"`positions` must leave {SUPPORT} cells between a creature and its image in "
            f"{box}, creature {np.argmax(wide)} is {x:.4g} by {y:.4g}."
        )
