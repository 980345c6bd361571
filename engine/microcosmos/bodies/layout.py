"""Layout of bodies without loops, from their first node by angles and lengths."""

from dataclasses import dataclass

import numpy as np

from .graph import Body

MAX_NODES = 1024
"""Most nodes of a body that is laid out: memory grows with their square."""


@dataclass(frozen=True)
class Layout:
    """The forward kinematics of a body: the positions of nodes by angles and lengths."""

    angle: np.ndarray
    """(edge,) direction of each edge of the unchanged body, in rad."""
    length: np.ndarray
    """(edge,) its length, in cells."""
    joints: np.ndarray
    """(joint, 2) pairs of edges."""
    free: np.ndarray
    """(turn,) joints that turn independently; the last one around a branch follows."""
    turned: np.ndarray
    """(edge, turn) factor by which the turn of a joint turns an edge."""
    paths: np.ndarray
    """(node, edge) sign with which the path from the first node has each edge, or 0."""


def layout(body: Body) -> Layout:
    """Return the layout of a body.

    Raises `ValueError` where it has loops, several parts, or too many nodes.
    """
    nodes, edges = len(body.positions), len(body.edges)
    if nodes > MAX_NODES:
        raise ValueError(f"a body to lay out must have at most {MAX_NODES} nodes, got {nodes}")
    parts, _, paths = _forest(nodes, body.edges)
    if edges != nodes - 1 or parts > 1:
        raise ValueError(
            f"a body to lay out must be one piece without loops, got {nodes} nodes and "
            f"{edges} edges"
        )
    _, free, turned = _forest(edges, body.joints)
    x, y = (body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]).T
    return Layout(
        angle=np.arctan2(y, x),
        length=np.hypot(x, y),
        joints=body.joints,
        free=np.array(free, int),
        turned=turned[:, free],
        paths=paths,
    )


def _forest(count: int, pairs: np.ndarray) -> tuple[int, list[int], np.ndarray]:
    """Return a spanning forest of `count` items: its trees, its pairs, and the paths.

    A path is a row of the signs with which each pair lies on the way from the tree's root.
    """
    neighbours: list[list[tuple[int, int, int]]] = [[] for _ in range(count)]
    for number, (first, second) in enumerate(pairs.tolist()):
        neighbours[first].append((number, second, 1))
        neighbours[second].append((number, first, -1))
    paths = np.zeros((count, len(pairs)), np.int8)
    trees, visited, used = 0, set(), []
    for root in range(count):
        if root in visited:
            continue
        trees += 1
        visited.add(root)
        waiting = [root]
        while waiting:
            item = waiting.pop()
            for number, other, sign in neighbours[item]:
                if other not in visited:
                    visited.add(other)
                    used.append(number)
                    waiting.append(other)
                    paths[other] = paths[item]
                    paths[other, number] = sign
    return trees, sorted(used), paths
