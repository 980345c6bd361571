"""Where bodies start in the box, and refusal of those that start in an obstacle."""

import numpy as np

from .body import Body, is_unavailable, shape
from .obstacles import crowded
from .search import Task
from .world import World

CLEARANCE = 2
"""Least distance of a node at the start from the middle of a solid cell, in cells."""


def headings(task: Task) -> np.ndarray:
    """Return the turns of the body about its middle at the start of each trial, in rad."""
    return np.pi / 4 * np.arange(task.trials)


def starts(world: World, body: Body, task: Task) -> np.ndarray:
    """Return the places (trial, node, 2) of nodes at the start of each trial, in cells."""
    found = shape(body).positions
    arms = found - found.mean(0)
    c, s = np.cos(headings(task)), np.sin(headings(task))
    turns = np.stack([c, s, -s, c], 1).reshape(-1, 2, 2)
    return arms[None] @ turns + np.array([world.width, world.height]) / 2


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
