"""Bodies: nodes, edges and joints as NumPy data."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .checks import refuse_malformed
from .colouring import Colour, colour


@dataclass(frozen=True)
class Body:
    """Filaments at rest, in cells and radians, of one creature or several."""

    positions: np.ndarray
    """(node, 2)."""
    edges: np.ndarray
    """(edge, 2) node numbers; an edge's direction is from the first to the second."""
    joints: np.ndarray
    """(joint, 2) numbers of edges that share a node."""
    rest_length: np.ndarray
    rest_angle: np.ndarray
    """(joint,) direction of the second edge minus that of the first."""
    stretch: np.ndarray
    shear: np.ndarray
    bend: np.ndarray
    arc: np.ndarray
    """(node,) position along the creature from 0 to 1."""
    member: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    """(node,) creature of each node, ascending from 0; one creature if left out."""
    crossing: bool = False
    """True if filaments may cross, with nodes nearer than `MIN_GAP`."""

    def __post_init__(self):
        if not len(self.member):
            object.__setattr__(self, "member", np.zeros(len(self.positions), int))
        refuse_malformed(vars(self))

    @property
    def count(self) -> int:
        """Return the number of creatures."""
        return int(self.member[-1]) + 1

    @cached_property
    def joint_nodes(self) -> np.ndarray:
        """(joint,) node that the two edges share."""
        first, second = self.edges[self.joints[:, 0]], self.edges[self.joints[:, 1]]
        shared = (first[:, :, None] == second[:, None, :]).any(2)
        return np.where(shared[:, 0], first[:, 0], first[:, 1])

    @cached_property
    def edge_colours(self) -> tuple[Colour, ...]:
        return colour(self.edges, self.member)

    @cached_property
    def joint_colours(self) -> tuple[Colour, ...]:
        if not len(self.joints):
            return ()
        return colour(self.joints, self.member[self.edges[:, 0]])
