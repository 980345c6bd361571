"""Filaments along a circle about the origin, closed or open."""

import numpy as np

from .graph import Body
from .shape import from_edges


def ring(
    nodes: int, spacing: float, *, stretch: float = 1.0, shear: float = 1.0, bend: float = 1.0
) -> Body:
    """A closed circle, anticlockwise from the node furthest along x."""
    if nodes < 3:
        raise ValueError(f"`nodes` must be at least 3, got {nodes}.")
    number, turn = np.arange(nodes), 2 * np.pi / nodes
    return from_edges(
        _on_circle(number * turn, turn, spacing),
        np.stack([number, (number + 1) % nodes], 1),
        number / nodes,
        stretch=stretch,
        shear=shear,
        bend=bend,
    )


def arc(
    nodes: int,
    spacing: float,
    gap: float,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """A circle with its share `gap` missing about the x axis, anticlockwise."""
    if nodes < 2:
        raise ValueError(f"`nodes` must be at least 2, got {nodes}.")
    if not 0 < gap < 1:
        raise ValueError(f"`gap` must be between 0 and 1, got {gap:g}.")
    number, turn = np.arange(nodes), 2 * np.pi * (1 - gap) / (nodes - 1)
    return from_edges(
        _on_circle(np.pi * gap + number * turn, turn, spacing),
        np.stack([number[:-1], number[1:]], 1),
        number / (nodes - 1),
        stretch=stretch,
        shear=shear,
        bend=bend,
    )


def _on_circle(angle: np.ndarray, turn: float, spacing: float) -> np.ndarray:
    """Places at `angle`, on a circle on which `turn` makes a chord of `spacing`."""
    radius = 0.5 * spacing / np.sin(turn / 2)
    return radius * np.stack([np.cos(angle), np.sin(angle)], 1)
