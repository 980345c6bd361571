"""Body plans: genes of segments, and the fixed sizes of the bodies that grow from them."""

from dataclasses import dataclass
from typing import Any, NamedTuple

LEAST_ROOT = 15
LEAST_LIMB = 3
LEAST_RING = 9
"""Least nodes of the root, of another segment and of a ring, without their base.

The fluid does not resolve smaller ones. Evolution makes none; a smaller ring does not grow.
"""


class Plan(NamedTuple):
    """The genes of a body plan, one row for each segment; used rows come first.

    Row 0 is the root. Every other segment stands behind the one that it is attached to.
    """

    used: Any
    number: Any
    """Innovation number."""
    parent: Any
    """Row of the segment that this one is attached to."""
    place: Any
    """Place on the parent, from its first node (0) to its last (1)."""
    angle: Any
    """Direction at the base relative to the parent's there, in rad."""
    nodes: Any
    """Nodes that the segment adds."""
    curl: Any
    """Rest curvature: angle from its first edge to its last, in rad; none in a ring."""
    stiffness: Any
    """Bending stiffness of its joints, from 0 to 1."""
    mirrored: Any
    """Whether there is a mirror image on the other side of the parent."""
    copies: Any
    """Copies: evenly along an open parent up to `place`, around a ring or the root's base."""
    closed: Any
    """Whether the segment is a ring that returns to its base."""


@dataclass(frozen=True)
class Capacity:
    """Fixed sizes of every body, and limits of its growth."""

    nodes: int
    """Rows of nodes, of which the last stays empty."""
    segments: int
    rings: int
    """Most rings."""
    limbs: int
    """Most copies of one segment in a body."""
    length: float
    """Largest distance between two nodes along the body, in cells."""
    spacing: float = 1.0
    """Length of an edge at rest, in cells."""

    @property
    def edges(self) -> int:
        return self.nodes - 1 + self.rings

    @property
    def joints(self) -> int:
        return self.nodes - 2 + 2 * self.rings
