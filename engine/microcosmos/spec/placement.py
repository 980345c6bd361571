"""Where bodies start in the box, and refusal of those that start in an obstacle."""

import numpy as np

from .body import Body, GrownBody, is_unavailable, shape
from .obstacles import crowded
from .search import Task
from .world import World

CLEARANCE = 2
"""Least distance of a node at the start from the middle of a solid cell, in cells."""


EVERY_WAY = np.pi * np.arange(32) / 32
"""Directions of a body that grows, in rad."""


def headings(task: Task) -> np.ndarray:
    """Return the turns of the body about its middle at the start of each trial, in rad."""
    return np.pi / 4 * np.arange(task.trials)


def starts(world: World, body: Body, task: Task) -> np.ndarray:
    """Return the places (trial, node, 2) of nodes at the start of each trial, in cells.

    A body that grows may have any direction: its longest filament is put in all of them.
    """
    found = shape(body).positions
    if isinstance(body, GrownBody):
        found = np.concatenate([_turned(found, angle) for angle in EVERY_WAY])
    middle = np.array([world.width, world.height]) / 2
    return np.stack([_turned(found, angle) + middle for angle in headings(task)])


def _turned(positions: np.ndarray, angle: float) -> np.ndarray:
    """Return positions turned about their mean, relative to it."""
    c, s = np.cos(angle), np.sin(angle)
    return (positions - positions.mean(0)) @ np.array([[c, s], [-s, c]])


def refuse_blocked(world: World, body: Body, task: Task) -> None:
    """Raise `ValueError` where the body, in any trial, starts in or at an obstacle."""
    solid = world.solid
    if solid is None or is_unavailable(body):  # A worker that can build it checks it.
        return
    for number, nodes in enumerate(starts(world, body, task)):
        blocked = np.flatnonzero(crowded(nodes, solid, CLEARANCE))
        if len(blocked):
            x, y = nodes[blocked[0]]
            owner = "world.obstacles" if world.obstacles else "world.flow"
            raise ValueError(
                f"`{owner}` must leave {CLEARANCE} cells around the `body`, which "
                f"starts in the middle of the box; got one at node {blocked[0]}, which starts "
                f"at ({x:.4g}, {y:.4g}) in trial {number + 1}"
            )
