"""Anatomy: the place of each node in the body at rest.

A limb is a maximal filament between nodes whose degree is not 2; a loop without branches is one
limb. A limb leads from its end nearer the first node of its piece to the other. The body's axis
is the line along x through the mean node: all builders draw bodies along x, and those with a
mirror axis have this one.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import exact
from .graph import Body
from .layout import pieces
from .shape import distances

TOLERANCE = 1e-6
"""Share of a creature's size below which a distance from its axis or middle counts as 0."""


@dataclass(frozen=True)
class Anatomy:
    """The place of each node (node,) in its creature.

    A node where limbs meet has the means of its positions and limbs. Nodes that mirror each
    other across the axis have opposite sides and y, and opposite limbs unless they are in one
    limb, which is its own mirror image.
    """

    position: np.ndarray
    """Path along the limb, from −1 to 1."""
    distance: np.ndarray
    """Path along edges from the first node of the piece, over the largest of the creature."""
    side: np.ndarray
    """−1, 0 or 1: right of the axis, on it, or left of it."""
    limb: np.ndarray
    """Number of the limb, from −1 to 1; a single limb has 0. Limbs are numbered anticlockwise,
    by the direction of their mean node from the creature's: first those right of the axis, then
    those on it, then those left of it."""
    x: np.ndarray
    """Place along x from the middle of the creature's bounding box, over half its size."""
    y: np.ndarray


def anatomy(body: Body) -> Anatomy:
    """Return the anatomy of every creature of a body."""
    values = np.zeros((6, len(body.positions)))
    paths = _paths(body)
    limbs = _limbs(body, paths)
    for member in range(body.count):
        nodes = body.member == member
        p = body.positions[nodes]
        low, high = p.min(0), p.max(0)
        size = float(np.max(high - low)) or 1.0
        tolerance = TOLERANCE * size
        middle = p.mean(0)
        own = [limb for limb in limbs if body.member[limb[0]] == member]
        along, number = _along(body, own), _numbers(body, own, middle, tolerance)
        away = _cleared(p[:, 1] - middle[1], tolerance)
        values[:, nodes] = [
            _means(own, along, len(body.positions))[nodes],
            paths[nodes] / max(paths[nodes].max(), 1e-12),
            np.sign(away),
            _means(own, number, len(body.positions))[nodes],
            *((p - 0.5 * (low + high)) / (0.5 * size)).T,
        ]
    return Anatomy(*values)


def _paths(body: Body) -> np.ndarray:
    """Return the path from the first node of its connected piece to each node, in cells."""
    count = len(body.positions)
    piece = pieces(body.edges, count)
    starts = np.unique(piece, return_index=True)[1].tolist()
    each = [distances(count, body.edges, body.rest_length, start) for start in starts]
    return np.min(each, 0)


def _limbs(body: Body, paths: np.ndarray) -> list[list[int]]:
    """Return the nodes of each limb, in their order; a closed limb ends at its first node."""
    neighbours: list[list[int]] = [[] for _ in body.positions]
    for first, second in body.edges.tolist():
        neighbours[first].append(second)
        neighbours[second].append(first)
    left = {frozenset(edge) for edge in body.edges.tolist()}
    ends = [node for node, near in enumerate(neighbours) if len(near) != 2]
    limbs = []
    for start in [*ends, *range(len(neighbours))]:  # Then loops without branches.
        for onward in neighbours[start]:
            if frozenset((start, onward)) not in left:
                continue
            limb = [start, onward]
            left.discard(frozenset(limb))
            while len(near := neighbours[limb[-1]]) == 2 and limb[-1] != start:
                limb.append(near[0] if near[0] != limb[-2] else near[1])
                left.discard(frozenset(limb[-2:]))
            limbs.append(limb if paths[start] <= paths[limb[-1]] else limb[::-1])
    return limbs


def _along(body: Body, limbs: list[list[int]]) -> list[np.ndarray]:
    """Return the path along each limb to its nodes, from −1 to 1."""
    length = {
        frozenset(edge): cells
        for edge, cells in zip(body.edges.tolist(), body.rest_length.tolist(), strict=True)
    }
    positions = []
    for limb in limbs:
        steps = [length[frozenset(pair)] for pair in pairwise(limb)]
        path = np.concatenate([[0.0], np.cumsum(steps)])
        positions.append(2 * path / path[-1] - 1)
    return positions


def _numbers(
    body: Body, limbs: list[list[int]], middle: np.ndarray, tolerance: float
) -> list[float]:
    """Return the number of each limb, −1 to 1."""
    means = [body.positions[_nodes(limb)].mean(0) - middle for limb in limbs]
    x, y = _cleared(np.array(means).reshape(-1, 2), tolerance).T
    # Directions that differ by rounding errors alone keep the order of their limbs.
    direction = np.round(np.where(y == 0, 0.0, exact.angle(y, x)), 6)
    ranks = np.empty(len(limbs))
    ranks[np.argsort(direction, kind="stable")] = np.arange(len(limbs))
    return [2 * rank / (len(limbs) - 1) - 1 if len(limbs) > 1 else 0.0 for rank in ranks]


def _means(limbs: list[list[int]], values: list, count: int) -> np.ndarray:
    """Return the mean of each node's values over the limbs that it is in, else 0."""
    total, times = np.zeros(count), np.zeros(count)
    for limb, one in zip(limbs, values, strict=True):
        nodes = _nodes(limb)
        # A value of the limb, or one for each node, of which a closed limb has one too many.
        total[nodes] += np.broadcast_to(one, len(limb))[: len(nodes)]
        times[nodes] += 1
    return total / np.maximum(times, 1)


def _nodes(limb: list[int]) -> list[int]:
    """Return the nodes of a limb, each once."""
    return limb[:-1] if limb[0] == limb[-1] else limb


def _cleared(values: np.ndarray, tolerance: float) -> np.ndarray:
    """Return values with 0 in place of those below the tolerance, which are rounding errors."""
    return np.where(np.abs(values) < tolerance, 0.0, values)
