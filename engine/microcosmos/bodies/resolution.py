"""Bodies with more nodes, for finer worlds, or with fewer, for drawings."""

from dataclasses import dataclass

import numpy as np

from .graph import Body


@dataclass(frozen=True)
class Refined:
    """A body with every edge halved, and the mapping from the original."""

    body: Body
    nodes: np.ndarray
    """(node of the original,) its new number."""
    edges: np.ndarray
    """(new edge,) the original edge that it halves."""
    joints: np.ndarray
    """(joint of the original,) its new number; the others lie in the middle of an edge."""


def subdivided(body: Body) -> Refined:
    """Halve every edge by a new node, in a world twice as large.

    Edges keep their length in cells. Joints keep angle and stiffness; new joints hold the
    halves of an edge straight.
    """
    first, second = body.edges.T
    count = len(body.edges)
    order = np.argsort(np.concatenate([body.member, body.member[first]]), kind="stable")
    number = np.argsort(order)  # Original nodes, then middles.
    middle = number[len(body.positions) :]
    halves = np.stack([number[first], middle, middle, number[second]], 1).reshape(-1, 2)
    places = body.positions[first] + body.positions[second]
    bent = 2 * body.joints + (body.edges[body.joints, 1] == body.joint_nodes[:, None])
    straight = 2 * np.arange(count)[:, None] + np.arange(2)[None]
    return Refined(
        body=Body(
            positions=np.concatenate([2 * body.positions, places])[order],
            edges=halves,
            joints=np.concatenate([bent, straight]),
            rest_length=np.repeat(body.rest_length, 2),
            rest_angle=np.concatenate([body.rest_angle, np.zeros(count)]),
            stretch=np.repeat(body.stretch, 2),
            shear=np.repeat(body.shear, 2),
            bend=np.concatenate([body.bend, np.ones(count)]),
            arc=np.concatenate([body.arc, _between(body.arc[first], body.arc[second])])[order],
            member=np.concatenate([body.member, body.member[first]])[order],
            crossing=body.crossing,
        ),
        nodes=number[: len(body.positions)],
        edges=np.repeat(np.arange(count), 2),
        joints=np.arange(len(body.joints)),
    )


def _between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the middle of `a` and `b`; across a ring's end, through 1."""
    closing = (np.abs(a - b) > 0.5) & (np.abs(a - b) < 1)
    return np.where(closing, (np.maximum(a, b) + 1) / 2, (a + b) / 2)


def thinned(body: Body, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and edges of about `most` nodes: ends, branches and nodes in between."""
    every = -(-len(body.positions) // most)
    if every == 1:
        return body.positions, body.edges
    # Ends and branches are always kept, so that a drawing has the form of the body.
    chosen = np.bincount(body.edges.ravel(), minlength=len(body.positions)) != 2
    chosen[::every] = True
    number = np.cumsum(chosen) - 1
    edges = [(number[a], number[b]) for a, b in _spans(body.edges, chosen)]
    return body.positions[chosen], np.array(edges, int).reshape(-1, 2)


def _spans(edges: np.ndarray, chosen: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs of chosen nodes that become neighbours, each path once."""
    incident: list[list[int]] = [[] for _ in chosen]
    for number, ends in enumerate(edges.tolist()):
        for node in ends:
            incident[node].append(number)
    visited, spans = set(), []
    for start in np.flatnonzero(chosen).tolist():
        for number in incident[start]:
            if number not in visited:
                spans.append((start, _follow(start, number, edges, incident, chosen, visited)))
    return spans


def _follow(node: int, edge: int, edges, incident, chosen, visited: set[int]) -> int:
    """Return the first chosen node along a path of edges, which are marked as visited."""
    while True:
        visited.add(edge)
        # The other end of the edge, and below the other edge of the node: both have two.
        node = int(edges[edge].sum()) - node
        if chosen[node]:
            return node
        edge = sum(incident[node]) - edge
