"""How far a body reaches, however it bends."""

import numpy as np

from .graph import Body
from .shape import distances


def extent(body: Body) -> float:
    """The longest way along edges between two nodes, in cells; of loops the shorter way.

    Found from the node farthest from a first one: exact without loops, and for one loop.
    """
    farthest, _ = _farthest(body, 0)
    return _farthest(body, farthest)[1]


def _farthest(body: Body, start: int) -> tuple[int, float]:
    """The node farthest from `start` along edges, and its distance."""
    way = distances(len(body.positions), body.edges, body.rest_length, start)
    way[np.isinf(way)] = -1.0
    last = int(np.argmax(way))
    return last, float(way[last])
