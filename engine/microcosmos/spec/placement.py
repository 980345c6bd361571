"""Where bodies start in the box, and refusal of those that lack room there."""

from math import ceil

import numpy as np

from .base import enough
from .body import Body, GrownBody, is_unavailable, shape
from .obstacles import crowded
from .search import Task
from .world import World

GAP = 3
"""Least distance between copies at the start, in cells."""

CLEARANCE = 2
"""Least distance of a node at the start from the middle of a solid cell, in cells."""


EVERY_WAY = np.pi * np.arange(32) / 32
"""Directions of a body that grows, in rad."""


def headings(task: Task) -> np.ndarray:
    """Return the turns of the body about its middle at the start of each trial, in rad."""
    return np.pi / 4 * np.arange(task.trials)


def arms(body: Body, task: Task) -> np.ndarray:
    """Return nodes (trial, node, 2) about their mean at the start of each trial, in cells.

    A body that grows may have any direction: its longest filament is put in all of them.
    """
    found = shape(body).positions
    if isinstance(body, GrownBody):
        found = found - found.mean(0)
        found = np.concatenate([found @ _turn(angle) for angle in EVERY_WAY])
    return (found - found.mean(0))[None] @ np.stack([_turn(one) for one in headings(task)])


def _turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def places(world: World) -> np.ndarray:
    """Return the places (copy, 2) of the middles of bodies at the start, in cells."""
    about = np.zeros((1, 2)) if world.copies is None else world.copies.places
    return about + np.array([world.width, world.height]) / 2


def refuse_crowded(world: World, body: Body, task: Task) -> None:
    """Raise `ValueError` where copies, in any trial, start too near each other."""
    copies = world.copies
    if copies is None or is_unavailable(body):  # A worker that can build it checks it.
        return
    reach = np.ptp(arms(body, task), axis=1).max(0)
    for axis, (count, side) in enumerate(zip(copies.shape, ("width", "height"), strict=True)):
        needed = reach[axis] + GAP
        if count > 1 and copies.spacing < needed:
            raise ValueError(
                f"`world.copies.spacing` must be at least {enough(needed)} cells for a `body` "
                f"that reaches {reach[axis]:.4g} cells along the {side}; got "
                f"{copies.spacing:.12g}"
            )
        needed += (count - 1) * copies.spacing
        if getattr(world, side) < needed:
            raise ValueError(
                f"`world.{side}` must be at least {ceil(needed)} cells for {copies.count} "
                f"`world.copies`; got {getattr(world, side)}"
            )


def refuse_blocked(world: World, body: Body, task: Task) -> None:
    """Raise `ValueError` where the body, in any trial, starts in or at an obstacle."""
    solid = world.solid
    if solid is None or is_unavailable(body):  # A worker that can build it checks it.
        return
    middles = places(world)[:, None]
    for number, one in enumerate(arms(body, task)):
        nodes = (middles + one[None]).reshape(-1, 2)
        blocked = np.flatnonzero(crowded(nodes, solid, CLEARANCE))
        if len(blocked):
            x, y = nodes[blocked[0]]
            owner = "world.obstacles" if world.obstacles else "world.flow"
            raise ValueError(
                f"`{owner}` must leave {CLEARANCE} cells around the `body`, which "
                f"starts in the middle of the box; got one at node {blocked[0]}, which starts "
                f"at ({x:.4g}, {y:.4g}) in trial {number + 1}"
            )
