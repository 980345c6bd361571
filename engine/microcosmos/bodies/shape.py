"""Bodies from nodes and edges, at rest as they are drawn."""

import heapq
from typing import TypedDict

import numpy as np

from .. import exact
from .graph import Body


class Stiffness(TypedDict, total=False):
    """Stiffness of a body, the same everywhere; 1 where left out."""

    stretch: float
    shear: float
    bend: float


def from_edges(
    positions: np.ndarray,
    edges: np.ndarray,
    arc: np.ndarray | None = None,
    *,
    rest_length: np.ndarray | None = None,
    stretch: float | np.ndarray = 1.0,
    shear: float | np.ndarray = 1.0,
    bend: float | np.ndarray = 1.0,
) -> Body:
    """Build a body whose joints, lengths and angles are those of the drawing.

    Two edges at a node are joined; at a branch of three or more, each is joined to its
    neighbours on both sides. By default `arc` is the path from the first node along the edges,
    and `rest_length` (also where NaN) the drawn length.
    """
    positions, edges = np.asarray(positions, float), np.asarray(edges, int).reshape(-1, 2)
    joints = joints_of(positions, edges)
    v = positions[edges[:, 1]] - positions[edges[:, 0]]
    angle = exact.angle(v[:, 1], v[:, 0])
    length = exact.length(v[:, 0], v[:, 1])
    if rest_length is not None:
        length = np.where(np.isnan(rest_length), length, rest_length)
    return Body(
        positions=positions,
        edges=edges,
        joints=joints,
        rest_length=length,
        rest_angle=wrap(angle[joints[:, 1]] - angle[joints[:, 0]]),
        stretch=np.broadcast_to(stretch, len(edges)).astype(float),
        shear=np.broadcast_to(shear, len(edges)).astype(float),
        bend=np.broadcast_to(bend, len(joints)).astype(float),
        arc=_arc(len(positions), edges, length) if arc is None else arc,
    )


def wrap(angle: np.ndarray) -> np.ndarray:
    """Return the same angle within ±π."""
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))


def joints_of(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return joints in the order of their nodes, incoming edges before outgoing ones."""
    met: list[list[tuple[int, int]]] = [[] for _ in positions]
    for number, (first, second) in enumerate(edges.tolist()):
        for node, leaves in ((first, 1), (second, 0)):
            if not 0 <= node < len(positions):
                raise ValueError(
                    f"`edges` must be pairs of nodes 0 to {len(positions) - 1}, got {node}."
                )
            met[node].append((leaves, number))
    pairs = []
    for node, found in enumerate(met):
        if len(found) == 2:
            pairs.append([number for _, number in sorted(found)])
        elif len(found) > 2:
            pairs.extend(_cyclic(node, [number for _, number in found], positions, edges))
    return np.array(pairs, int).reshape(-1, 2)


def _cyclic(node: int, met: list[int], positions: np.ndarray, edges: np.ndarray):
    """Return pairs of neighbours among a node's edges, anticlockwise."""
    far = np.sum(edges[met], 1) - node
    v = positions[far] - positions[node]
    round_about = np.array(met)[np.argsort(exact.angle(v[:, 1], v[:, 0]), kind="stable")]
    return np.stack([round_about, np.roll(round_about, -1)], 1).tolist()


def distances(nodes: int, edges: np.ndarray, length: np.ndarray, start: int = 0) -> np.ndarray:
    """Return the cells along edges from `start` to every node; infinite without a path."""
    neighbours: list[list[tuple[int, float]]] = [[] for _ in range(nodes)]
    for (first, second), cells in zip(edges.tolist(), length.tolist(), strict=True):
        neighbours[first].append((second, cells))
        neighbours[second].append((first, cells))
    distance = np.full(nodes, np.inf)
    distance[start], waiting = 0, [(0.0, start)]
    while waiting:
        here, node = heapq.heappop(waiting)
        for other, cells in neighbours[node]:
            if here + cells < distance[other]:
                distance[other] = here + cells
                heapq.heappush(waiting, (here + cells, other))
    return distance


def _arc(nodes: int, edges: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return shares of the path from the first node to the furthest; 0 without a path."""
    distance = distances(nodes, edges, length)
    distance[np.isinf(distance)] = 0
    return distance / max(distance.max(), 1e-12)


def extent(body: Body) -> float:
    """Return the longest path along edges between two nodes, in cells.

    The path is found from the node farthest from the first node: exact without loops, and for
    one loop, of which the shorter way counts.
    """
    farthest, _ = _farthest(body, 0)
    return _farthest(body, farthest)[1]


def _farthest(body: Body, start: int) -> tuple[int, float]:
    distance = distances(len(body.positions), body.edges, body.rest_length, start)
    distance[np.isinf(distance)] = -1.0
    last = int(np.argmax(distance))
    return last, float(distance[last])
