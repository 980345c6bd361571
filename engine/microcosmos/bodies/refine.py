"""The same body at twice the resolution."""

from dataclasses import dataclass

import numpy as np

from .graph import Body


@dataclass(frozen=True)
class Refined:
    """A body with every edge halved, and where its parts come from."""

    body: Body
    nodes: np.ndarray
    """(node of the original,) its number now."""
    edges: np.ndarray
    """(edge now,) the edge of the original that it is half of."""
    joints: np.ndarray
    """(joint of the original,) its number now; all others are in the middle of an edge."""


def subdivided(body: Body) -> Refined:
    """Every edge halved by a new node, in a world twice as large.

    Edges keep their length in cells. Joints keep angle and stiffness; a new one holds the
    two halves of an edge straight.
    """
    first, second = body.edges.T
    count = len(body.edges)
    order = np.argsort(np.concatenate([body.member, body.member[first]]), kind="stable")
    number = np.argsort(order)  # Of the original nodes, then of the middles.
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
    """Half way from `a` to `b`; on a ring, the way through 1 is the shorter one."""
    closing = (np.abs(a - b) > 0.5) & (np.abs(a - b) < 1)
    return np.where(closing, (np.maximum(a, b) + 1) / 2, (a + b) / 2)
