"""Bodies that branch."""

import numpy as np

from .graph import Body
from .shape import from_edges

NARROWING = 0.9
"""From one level of forks to the next; equal forks lead to one place by several ways."""


def star(
    arms: int,
    arm_nodes: int,
    spacing: float,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """Straight arms of `arm_nodes` nodes each, evenly about a middle node that is the first."""
    _refuse_fewer("arms", arms, 1)
    _refuse_fewer("arm_nodes", arm_nodes, 1)
    turn = 2 * np.pi * np.arange(arms) / arms
    along = spacing * np.arange(1, arm_nodes + 1)
    tips = np.stack([np.cos(turn), np.sin(turn)], 1)[:, None] * along[None, :, None]
    outer = 1 + np.arange(arms * arm_nodes).reshape(arms, arm_nodes)
    inner = np.concatenate([np.zeros((arms, 1), int), outer[:, :-1]], 1)
    return from_edges(
        np.concatenate([np.zeros((1, 2)), tips.reshape(-1, 2)]),
        np.stack([inner.reshape(-1), outer.reshape(-1)], 1),
        stretch=stretch,
        shear=shear,
        bend=bend,
    )


def tree(
    levels: int,
    branches: int,
    segment_nodes: int,
    spacing: float,
    angle: float,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """A stem along x that ends in `branches` more, and so on to the last level.

    A segment adds `segment_nodes` nodes; `angle` lies between the outermost branches of the
    first fork, in radians, and narrows with every level. The first node is the root.
    """
    for name, value in (("levels", levels), ("branches", branches)):
        _refuse_fewer(name, value, 1)
    _refuse_fewer("segment_nodes", segment_nodes, 1)
    spread = angle * (np.linspace(-0.5, 0.5, branches) if branches > 1 else np.zeros(1))
    positions, edges, tips = [np.zeros(2)], [], [(0, 0.0)]
    for level in range(levels):
        turns = NARROWING ** (level - 1) * spread if level else np.zeros(1)
        tips = [
            _segment(positions, edges, tip, heading + turn, segment_nodes, spacing)
            for tip, heading in tips
            for turn in turns
        ]
    return from_edges(
        np.array(positions), np.array(edges), stretch=stretch, shear=shear, bend=bend
    )


def _segment(
    positions: list, edges: list, start: int, heading: float, nodes: int, spacing: float
) -> tuple[int, float]:
    """Append a straight segment; its tip and heading."""
    step = spacing * np.array([np.cos(heading), np.sin(heading)])
    origin, tip = positions[start], start
    for number in range(1, nodes + 1):
        edges.append((tip, len(positions)))
        tip = len(positions)
        positions.append(origin + number * step)
    return tip, heading


def _refuse_fewer(name: str, value: int, least: int) -> None:
    if value < least:
        raise ValueError(f"`{name}` must be at least {least}, got {value}.")
