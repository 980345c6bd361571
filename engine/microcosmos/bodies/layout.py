"""Layout of bodies: directions of edges and positions of nodes by rest angles and lengths."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import exact
from .graph import Body

MAX_NODES = 1024
"""Most nodes of a body that is laid out: memory grows with their square."""


@dataclass(frozen=True)
class Layout:
    """The forward kinematics of a body, by least squares where its loops and branches disagree.

    A branch of d edges has d joints, of which d − 1 turn independently, and a loop closes; so
    rest angles and lengths may contradict each other there.
    """

    angle: np.ndarray
    """(edge,) direction of each edge of the unchanged body, in rad."""
    rest_angle: np.ndarray
    """(joint,) rest angles of the unchanged body, in rad."""
    joints: np.ndarray
    """(joint, 2) pairs of edges."""
    turned: np.ndarray
    """(edge, joint) factor by which the turn of a joint turns an edge."""
    placed: np.ndarray
    """(node, edge) factor by which an edge moves a node from the middle of its piece."""
    piece: np.ndarray
    """(node,) number of the connected piece, from 0."""


def layout(body: Body) -> Layout:
    """Return the layout of a body; raise `ValueError` for more than `MAX_NODES` nodes."""
    nodes, edges = len(body.positions), len(body.edges)
    if nodes > MAX_NODES:
        raise ValueError(f"a body to lay out must have at most {MAX_NODES} nodes, got {nodes}")
    x, y = (body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]).T
    return Layout(
        angle=exact.angle(y, x),
        rest_angle=body.rest_angle,
        joints=body.joints,
        turned=_inverse(body.joints, edges),
        placed=_inverse(body.edges, nodes),
        piece=pieces(body.edges, nodes),
    )


def is_exact(body: Body, theta_feedback: float | int, nu_c: Any) -> bool:
    """Return whether shape matching meets all constraints, so that none needs a sweep.

    It does for a body that can be laid out, at full stiffness and strength, if edge angles
    follow the geometry.
    """
    stiff = all(np.all(one == 1) for one in (body.stretch, body.shear, body.bend))
    small = len(body.positions) <= MAX_NODES
    return bool(stiff and small and nu_c is None and theta_feedback == 1)


def _inverse(pairs: np.ndarray, count: int) -> np.ndarray:
    """Return the matrix (item, pair) from differences, second item minus first, to items.

    It is the pseudoinverse: differences are met by least squares, and each connected piece has
    mean 0.
    """
    piece, found = pieces(pairs, count), np.zeros((count, len(pairs)))
    known: dict[bytes, np.ndarray] = {}  # Equal bodies have the same.
    for number in range(piece.max(initial=-1) + 1):
        items = np.flatnonzero(piece == number)
        own = np.flatnonzero(piece[pairs[:, 0]] == number)
        within = np.searchsorted(items, pairs[own])
        name = np.array([len(items), *within.ravel()]).tobytes()
        if name not in known:
            known[name] = _inverse_of_piece(within, len(items))
        found[np.ix_(items, own)] = known[name]
    return found


def _inverse_of_piece(pairs: np.ndarray, count: int) -> np.ndarray:
    """Return the same for a connected graph. With D the matrix of differences and J that of
    means, D⁺ = (DᵀD + J)⁻¹ Dᵀ."""
    first, second = pairs.T
    squares = np.zeros((count, count))  # Whole numbers, so that their order does not matter.
    for one, other in ((first, first), (second, second)):
        np.add.at(squares, (one, other), 1)
    for one, other in ((first, second), (second, first)):
        np.add.at(squares, (one, other), -1)
    inverse = exact.inverse(squares + 1 / count)
    return inverse[:, second] - inverse[:, first]


def pieces(edges: np.ndarray, nodes: int) -> np.ndarray:
    """Number the connected pieces of a graph, in the order of their first nodes."""
    lowest = np.arange(nodes)
    while True:
        lower = lowest.copy()
        np.minimum.at(lower, edges, lowest[edges].min(1, keepdims=True))
        if np.array_equal(lower, lowest):
            return np.unique(lowest, return_inverse=True)[1]
        lowest = lower
