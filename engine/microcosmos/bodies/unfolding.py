"""Bodies without loops, laid out from their first node by angles and lengths."""

from dataclasses import dataclass

import numpy as np

from .graph import Body

MOST = 1024
"""Nodes of a body that is laid out: what is needed grows with their square."""


@dataclass(frozen=True)
class Unfolded:
    """How edges hang on joints, and nodes on edges."""

    joints: np.ndarray
    """(free,) the joints that can be turned independently: the last one around a branch
    follows from the others."""
    turned: np.ndarray
    """(edge, free) how much a turn of each of these joints turns each edge."""
    ways: np.ndarray
    """(node, edge) how often, and in which sense, the way from the first node has each edge."""


def unfolded(body: Body) -> Unfolded:
    """How a body is laid out.

    Raises `ValueError` where it has loops or several parts, or too many nodes.
    """
    nodes, edges = len(body.positions), len(body.edges)
    if nodes > MOST:
        raise ValueError(f"a body that is laid out must have at most {MOST} nodes, got {nodes}")
    ways = _ways(body)
    if edges != nodes - 1 or ways is None:
        raise ValueError(
            f"a body that is laid out must be one piece without loops, got {nodes} nodes and "
            f"{edges} edges"
        )
    joints, turned = _turned(body)
    return Unfolded(joints, turned, ways)


def drawn(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """The angle and the length of every edge as the body stands."""
    v = body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]
    return np.arctan2(v[:, 1], v[:, 0]), np.hypot(v[:, 0], v[:, 1])


def _ways(body: Body) -> np.ndarray | None:
    """From the first node to every node, or None where some cannot be reached."""
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
    """The joints by which edges are found from an edge that stays, and what they turn."""
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
