"""Layout of bodies without loops, from their first node by angles and lengths."""

from dataclasses import dataclass

import numpy as np

from .graph import Body

MAX_NODES = 1024
"""Most nodes of a body that is laid out: memory grows with their square."""


@dataclass(frozen=True)
class Unfolded:
    """The dependence of edges on joints, and of nodes on edges."""

    joints: np.ndarray
    """(free,) joints that turn independently; the last one around a branch follows."""
    turned: np.ndarray
    """(edge, free) factor by which the turn of a joint turns an edge."""
    ways: np.ndarray
    """(node, edge) sign with which the path from the first node has each edge, or 0."""


def unfolded(body: Body) -> Unfolded:
    """Return the layout of a body.

    Raises `ValueError` where it has loops, several parts, or too many nodes.
    """
    nodes, edges = len(body.positions), len(body.edges)
    if nodes > MAX_NODES:
        raise ValueError(f"a body to lay out must have at most {MAX_NODES} nodes, got {nodes}")
    ways = _ways(body)
    if edges != nodes - 1 or ways is None:
        raise ValueError(
            f"a body to lay out must be one piece without loops, got {nodes} nodes and "
            f"{edges} edges"
        )
    joints, turned = _turned(body)
    return Unfolded(joints, turned, ways)


def drawn(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Return the angle and the length of every edge in the body's present positions."""
    v = body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]
    return np.arctan2(v[:, 1], v[:, 0]), np.hypot(v[:, 0], v[:, 1])


def _ways(body: Body) -> np.ndarray | None:
    """Return the paths from the first node, or None where some node cannot be reached."""
    met: list[list[tuple[int, int, int]]] = [[] for _ in body.positions]
    for number, (first, second) in enumerate(body.edges.tolist()):
        met[first].append((number, second, 1))
        met[second].append((number, first, -1))
    ways = np.zeros((len(met), len(body.edges)), np.int8)
    seen, waiting = {0}, [0]
    while waiting:
        node = waiting.pop()
        for number, other, sign in met[node]:
            if other not in seen:
                seen.add(other)
                waiting.append(other)
                ways[other] = ways[node]
                ways[other, number] = sign
    return ways if len(seen) == len(met) else None


def _turned(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Return the joints of a spanning tree of the edges, and the edges that each turns."""
    met: list[list[tuple[int, int, int]]] = [[] for _ in body.edges]
    for number, (first, second) in enumerate(body.joints.tolist()):
        met[first].append((number, second, 1))
        met[second].append((number, first, -1))
    turned = np.zeros((len(met), len(body.joints)), np.int8)
    seen, used = set(), []
    for root in range(len(met)):
        waiting = [] if root in seen else [root]
        seen.add(root)
        while waiting:
            edge = waiting.pop()
            for number, other, sign in met[edge]:
                if other not in seen:
                    seen.add(other)
                    used.append(number)
                    waiting.append(other)
                    turned[other] = turned[edge]
                    turned[other, number] = sign
    joints = np.array(sorted(used), int)
    return joints, turned[:, joints]
