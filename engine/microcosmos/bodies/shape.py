"""Construction of bodies from nodes and edges, at rest as they are drawn."""

import heapq
from math import inf, sqrt
from typing import Any, TypedDict

import numpy as np

from .. import exact
from ..invalid import InvalidField
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
    positions, edges = rows_of_two("positions", positions), _pairs(edges)
    joints = joints_of(positions, edges)
    v = positions[edges[:, 1]] - positions[edges[:, 0]]
    angle = exact.angle(v[:, 1], v[:, 0])
    length = exact.length(v[:, 0], v[:, 1])
    if rest_length is not None:
        length = np.where(np.isnan(rest_length), length, rest_length)
    body = Body(
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
    if len(loose := np.setdiff1d(np.arange(len(positions)), edges)):
        raise InvalidField("edges", f"must join every node; node {loose[0]} is in none.")
    return body


def rows_of_two(name: str, given: Any) -> np.ndarray:
    """Return places in double precision. Raise `InvalidField` unless they are rows (x, y)."""
    rows = np.asarray(given)
    if rows.ndim != 2 or rows.shape[1] != 2 or rows.dtype.kind not in "iuf":
        raise InvalidField(
            name, f"must be rows (x, y) of numbers, got {rows.dtype} in shape {rows.shape}."
        )
    return rows.astype(float)


def _pairs(given: Any) -> np.ndarray:
    edges = np.asarray(given)
    if edges.size == 0:  # A body without edges is refused as such.
        return np.zeros((0, 2), int)
    if edges.ndim != 2 or edges.shape[1] != 2 or edges.dtype.kind not in "iu":
        raise InvalidField(
            "edges",
            f"must be pairs of whole numbers, got {edges.dtype} in shape {edges.shape}.",
        )
    return edges.astype(int)


def wrap(angle: np.ndarray) -> np.ndarray:
    """Return the same angle within ±π."""
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))


def joints_of(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return joints in the order of their nodes, incoming edges before outgoing ones."""
    met: list[list[tuple[int, int]]] = [[] for _ in positions]
    for number, (first, second) in enumerate(edges.tolist()):
        for node, leaves in ((first, 1), (second, 0)):
            if not 0 <= node < len(positions):
                raise InvalidField(
                    "edges", f"must be pairs of nodes 0 to {len(positions) - 1}, got {node}."
                )
            met[node].append((leaves, number))
    pairs = []
    for node, at_node in enumerate(met):
        if len(at_node) == 2:
            pairs.append([number for _, number in sorted(at_node)])
        elif len(at_node) > 2:
            pairs.extend(_cyclic(node, [number for _, number in at_node], positions, edges))
    return np.array(pairs, int).reshape(-1, 2)


def _cyclic(node: int, met: list[int], positions: np.ndarray, edges: np.ndarray):
    """Return pairs of neighbours among a node's edges, anticlockwise."""
    far = np.sum(edges[met], 1) - node
    v = positions[far] - positions[node]
    turning = np.array(met)[np.argsort(exact.angle(v[:, 1], v[:, 0]), kind="stable")]
    return np.stack([turning, np.roll(turning, -1)], 1).tolist()


def rings(edges: np.ndarray, joints: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Return the joints that stand in a ring around a branch, as `filaments.Rings`.

    A ring has at least three joints at one node, and passes each of its edges once.
    """
    met: dict[int, list[int]] = {}
    for joint, (one, other) in enumerate(joints.tolist()):
        for node in sorted(set(edges[one].tolist()) & set(edges[other].tolist()))[:1]:
            met.setdefault(node, []).append(joint)
    found = [ring for _, at in sorted(met.items()) if (ring := _around(joints, at))]
    of, sign = np.full(len(joints), len(found)), np.zeros(len(joints))
    for number, ring in enumerate(found):
        for joint, way in ring:
            of[joint], sign[joint] = number, way
    return of, sign, len(found)


def _around(joints: np.ndarray, met: list[int]) -> list[tuple[int, int]]:
    """Return joints in the order of their ring, each with the way in which it is passed."""
    first, edge = joints[met[0]].tolist()
    ring, left = [(met[0], 1)], met[1:]
    while edge != first:
        at = [joint for joint in left if edge in joints[joint]]
        if len(at) != 1:
            return []  # The ring does not close, or has a fork.
        one, other = joints[at[0]].tolist()
        ring.append((at[0], 1 if one == edge else -1))
        left.remove(at[0])
        edge = other if one == edge else one
    return ring if not left and len(ring) >= 3 else []


def distances(nodes: int, edges: np.ndarray, length: np.ndarray, start: int = 0) -> np.ndarray:
    """Return the cells along edges from `start` to every node; infinite without a path."""
    found = _walked(_neighbours(nodes, edges, length), start)
    distance = np.full(nodes, np.inf)
    distance[list(found)] = list(found.values())
    return distance


Neighbours = list[list[tuple[int, float]]]
"""The neighbours of each node, and the lengths of the edges to them."""


def _neighbours(nodes: int, edges: np.ndarray, length: np.ndarray) -> Neighbours:
    neighbours: Neighbours = [[] for _ in range(nodes)]
    for (first, second), cells in zip(edges.tolist(), length.tolist(), strict=True):
        neighbours[first].append((second, cells))
        neighbours[second].append((first, cells))
    return neighbours


def _walked(neighbours: Neighbours, start: int) -> dict[int, float]:
    """Return the cells along edges from `start` to the nodes of its piece."""
    distance, waiting = {start: 0.0}, [(0.0, start)]
    while waiting:
        passed, node = heapq.heappop(waiting)
        for other, cells in neighbours[node]:
            if passed + cells < distance.get(other, inf):
                distance[other] = passed + cells
                heapq.heappush(waiting, (passed + cells, other))
    return distance


def _arc(nodes: int, edges: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return shares of the path from the first node to the furthest; 0 without a path."""
    distance = distances(nodes, edges, length)
    distance[np.isinf(distance)] = 0
    return distance / max(distance.max(), 1e-12)


def extent(body: Body) -> float:
    """Return the longest path along edges between two nodes, in cells.

    The path is found from the node farthest from a piece's first node: exact without loops, and
    for one loop, of which the shorter way counts.
    """
    neighbours = _neighbours(len(body.positions), body.edges, body.rest_length)
    longest, met = 0.0, set[int]()
    for start in range(len(neighbours)):
        if start not in met:
            piece = _walked(neighbours, start)
            met |= piece.keys()
            # In a tree, the node farthest from any node is an end of the longest path.
            end = max(sorted(piece), key=piece.__getitem__)
            longest = max(longest, *_walked(neighbours, end).values())
    return longest


def reach(body: Body) -> float:
    """Return the largest distance between nodes when filaments are straight, in cells.

    Unconnected filaments lie as far apart as they are drawn.
    """
    positions, longest = body.positions, extent(body)
    if np.isfinite(distances(len(positions), body.edges, body.rest_length)).all():
        return longest
    squares = max(float(np.sum((positions - one) ** 2, 1).max()) for one in positions)
    return max(longest, sqrt(squares))
