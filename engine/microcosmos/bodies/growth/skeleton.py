"""Edges, joints and forward kinematics of grown bodies.

Edge i − 1 leads to node i; behind the edges of all nodes follow those that close rings. Each
edge but the first has a joint with the edge before it, and the edge that closes a ring has one
with the ring's first edge too. So joints turn independently but for one in each ring, and rings
share no edge: least squares (`bodies.layout`) has a closed form, the mean around each ring.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..graph import Body
from .plan import Capacity, Grown, Plan
from .sprouting import grow


class Skeleton(NamedTuple):
    """A body of fixed sizes; absent edges and joints belong to the last, empty node."""

    edges: Any
    """(edge, 2)"""
    joints: Any
    """(joint, 2) edges."""
    driver: Any
    """(joint,) the node that commands it: the far one of its second edge."""
    edge_present: Any
    """(edge,) True if the edge exists."""
    bends: Any
    """(joint,) True if the joint exists."""
    hand: Any
    """(joint,) −1 in mirror images, otherwise 1."""
    angle: Any
    """(edge,) direction at rest, in rad."""
    rest_angle: Any
    """(joint,) in rad."""
    stiffness: Any
    """(joint,)"""
    turned: Any
    """(edge, joint) factor by which the turn of a joint turns an edge."""
    placed: Any
    """(node, edge) factor by which an edge moves a node from the middle of the body."""


def skeleton(
    grown: Grown, capacity: Capacity, xp: Any = np, loop: Callable | None = None
) -> Skeleton:
    """Return the edges, joints and kinematics of a grown body of arrays of `xp`."""
    reals = grown.positions.dtype
    edges, edge_present, angle = _edges(grown, capacity, xp)
    joints, bends, driver = _joints(grown, capacity, xp)
    rest = _wrapped(angle[joints[:, 1]] - angle[joints[:, 0]], xp)
    return Skeleton(
        edges=edges,
        joints=joints,
        driver=driver,
        edge_present=edge_present,
        bends=bends,
        hand=grown.hand[driver],
        angle=xp.where(edge_present, angle, 0).astype(reals),
        rest_angle=xp.where(bends, rest, 0).astype(reals),
        stiffness=grown.stiffness[driver],
        turned=_turned(grown, edge_present, bends, xp, loop),
        placed=_placed(grown, edge_present, xp, loop),
    )


def _edges(grown: Grown, capacity: Capacity, xp: Any) -> tuple[Any, Any, Any]:
    """Return edges (to each node but the first, then of rings), their mask and directions."""
    nodes, empty = capacity.nodes, capacity.nodes - 1
    reals, node = grown.positions.dtype, xp.arange(nodes, dtype=np.int32)
    ring = grown.ring_first >= 0
    last = xp.where(ring, grown.ring_last, empty)
    closing = xp.stack([last, xp.where(ring, grown.ring_base, empty)], 1)
    grown_to = xp.where(grown.present[1:, None], xp.stack([grown.before, node], 1)[1:], empty)
    corners = (grown.ring_last - grown.ring_first + 2).astype(reals)
    turn = grown.hand[last] * (xp.asarray(2 * np.pi, reals) * (1 / corners))
    return (
        xp.concatenate([grown_to, closing]).astype(np.int32),
        xp.concatenate([grown.present[1:], ring]),
        xp.concatenate([grown.heading[1:], xp.where(ring, grown.heading[last] + turn, 0)]),
    )


def _joints(grown: Grown, capacity: Capacity, xp: Any) -> tuple[Any, Any, Any]:
    """Return joints, their mask and their driving nodes.

    First come the joints of each node's edge with the edge before it, then those that close
    rings. All edges at the first node join the root's first edge.
    """
    nodes, rings, empty = capacity.nodes, capacity.rings, capacity.nodes - 1
    node, ring = xp.arange(nodes, dtype=np.int32), grown.ring_first >= 0
    absent = xp.asarray(empty - 1, np.int32)
    earlier = xp.maximum(grown.before - 1, 0)
    first = xp.where(grown.present, earlier, absent)[2:]
    second = xp.where(grown.present, node - 1, absent)[2:]
    into = xp.where(ring, grown.ring_last - 1, absent)
    out = xp.where(ring, grown.ring_first - 1, absent)
    closes = xp.where(ring, xp.arange(rings, dtype=np.int32) + nodes - 1, absent)
    pairs = ((first, second), (into, closes), (closes, out))
    joints = xp.concatenate([xp.stack(pair, 1) for pair in pairs])
    last = xp.where(ring, grown.ring_last, empty)
    driver = xp.concatenate([node[2:], last, xp.where(ring, grown.ring_first, empty)])
    exists = xp.concatenate([grown.present[2:], ring, ring])
    return joints.astype(np.int32), exists, driver.astype(np.int32)


def ancestors(before: Any, xp: Any, loop: Callable | None) -> Any:
    """Return the mask (node, other) of nodes on the path from each to the first, with both."""
    nodes = len(before)
    own = xp.eye(nodes, dtype=bool)

    # Nodes grow after the node before them, so that one pass in their order is enough.
    def step(row, known):
        line = known[before[row]] | own[row]
        return xp.where(xp.arange(nodes)[:, None] == row, line[None], known)

    if loop is not None:
        return loop(nodes, step, own)
    for row in range(nodes):
        own[row] |= own[before[row]]
    return own


def _placed(grown: Grown, edge_present: Any, xp: Any, loop: Callable | None) -> Any:
    """Return the factors by which edges move nodes."""
    way = ancestors(grown.before, xp, loop)[:, 1:] & edge_present[None, : len(grown.before) - 1]
    rings = len(grown.ring_first)
    way = xp.concatenate([way, xp.zeros((len(way), rings), bool)], 1)
    number = xp.arange(way.shape[1], dtype=np.int32)
    member = (number[None] >= grown.ring_first[:, None] - 1) & (
        number[None] < grown.ring_last[:, None]
    )
    member = member | (number[None] == len(way) - 1 + xp.arange(rings)[:, None])
    member = member & (grown.ring_first >= 0)[:, None]
    return _least_squares(way & grown.present[:, None], member, grown.present, xp)


def _turned(grown: Grown, edge_present: Any, bends: Any, xp: Any, loop: Any) -> Any:
    """Return the factors by which joints turn edges."""
    nodes, rings = len(grown.before), len(grown.ring_first)
    # Edges of the root hang on its first, as the tree of joints has it.
    hung = xp.where(xp.arange(nodes) <= 1, xp.arange(nodes), xp.maximum(grown.before, 1))
    way = ancestors(hung, xp, loop)[1:, 2:] & bends[None, : nodes - 2]
    own = xp.eye(rings, dtype=bool)
    ring = grown.ring_first >= 0
    none = xp.zeros((nodes - 1, 2 * rings), bool)
    last = xp.where(ring, grown.ring_last - 1, 0)
    closing = [way[last], own, xp.zeros((rings, rings), bool)]
    way = xp.concatenate([xp.concatenate([way, none], 1), xp.concatenate(closing, 1)])
    number = xp.arange(way.shape[1], dtype=np.int32)
    member = (number[None] >= grown.ring_first[:, None] - 1) & (
        number[None] < grown.ring_last[:, None] - 1
    )
    at = xp.arange(rings)[:, None] + nodes - 2
    member = member | (number[None] == at) | (number[None] == at + rings)
    return _least_squares(way & edge_present[:, None], member & ring[:, None], edge_present, xp)


def _least_squares(way: Any, member: Any, present: Any, xp: Any) -> Any:
    """Return the pseudoinverse of the differences of a tree and rings that share no edge.

    `way` (item, pair): the pairs on the way to each item; `member` (ring, pair). Each ring
    loses its mean, and all items theirs. Sums are of whole numbers, in any order.
    """
    reals = np.float32
    way, member = way.astype(reals), member.astype(reals)
    count = xp.maximum(xp.sum(present), 1).astype(reals)
    centred = way - (xp.sum(way, 0) * (1 / count))[None]
    size = 1 / xp.maximum(xp.sum(member, 1), 1)
    # Whole numbers first: the mean around a ring, then less its mean over the items.
    around = xp.sum(way[:, None] * member[None], 2)
    around = around - (xp.sum(around, 0) * (1 / count))[None]
    mean = around * size[None]
    factors = centred - xp.sum(mean[:, :, None] * member[None], 1)
    return xp.where(present[:, None], factors, 0).astype(reals)


def _wrapped(angle: Any, xp: Any) -> Any:
    """Return the same angle within ±π."""
    turn = xp.asarray(2 * np.pi, angle.dtype)
    return angle - turn * xp.round(angle * (1 / turn))


def grown_length(plan: Plan, capacity: Capacity) -> float:
    """Return the longest path along edges of the body that grows from a plan, in cells."""
    grown = grow(plan, capacity)
    apart = grown.distance[grown.present][:, grown.present]
    return capacity.spacing * float(apart.max())


def grown_body(plan: Plan, capacity: Capacity, softest: float = 1.0) -> Body:
    """Return the body that grows from a plan of NumPy arrays, in cells about its first node.

    `softest` is the stiffness of a joint whose gene is 0.
    """
    grown = grow(plan, capacity)
    bones = skeleton(grown, capacity)
    node, edge = np.cumsum(grown.present) - 1, np.cumsum(bones.edge_present) - 1
    away = np.where(grown.present, grown.distance[0], 0)
    ones = np.ones(int(bones.edge_present.sum()))
    stiff = bones.stiffness[bones.bends].astype(float)
    return Body(
        positions=grown.positions[grown.present].astype(float),
        edges=node[bones.edges[bones.edge_present]],
        joints=edge[bones.joints[bones.bends]],
        rest_length=capacity.spacing * ones,
        rest_angle=bones.rest_angle[bones.bends].astype(float),
        stretch=ones,
        shear=ones,
        bend=softest ** (1 - stiff),
        arc=(away / max(away.max(), 1))[grown.present].astype(float),
    )
