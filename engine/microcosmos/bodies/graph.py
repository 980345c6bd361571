"""Bodies: nodes, edges and joints as NumPy data; their placement and combination."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np

from .. import exact
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


INDEXED_BY = {"edges": "positions", "joints": "edges"}


def placed(body: Body, centre: Sequence[int | float] | np.ndarray, turned: float = 0.0) -> Body:
    """Turn a body anticlockwise about its mean node position and move that to `centre`."""
    c, s = exact.cosine(turned), exact.sine(turned)
    arms = body.positions - body.positions.mean(0)
    x, y = arms.T
    rotated = np.stack([c * x - s * y, s * x + c * y], 1) if turned else arms
    return replace(body, positions=rotated + np.asarray(centre, float))


def combined(bodies: Sequence[Body]) -> Body:
    """Combine bodies into one, their creatures numbered in turn."""
    if not bodies:
        raise ValueError("`bodies` must hold at least one body, got none.")
    arrays = {}
    for name in (f.name for f in fields(Body) if f.name != "crossing"):
        parts = [getattr(body, name) for body in bodies]
        arrays[name] = np.concatenate(parts)
        if name in INDEXED_BY:
            sizes = [len(getattr(body, INDEXED_BY[name])) for body in bodies]
            arrays[name] = arrays[name] + _offsets(sizes, parts)[:, None]
    counts = [body.count for body in bodies]
    arrays["member"] = arrays["member"] + _offsets(counts, [b.member for b in bodies])
    return Body(**arrays, crossing=any(body.crossing for body in bodies))


def _offsets(sizes: list[int], parts: list[np.ndarray]) -> np.ndarray:
    """Return, for each entry of the joined parts, the sizes of the bodies before it."""
    return np.repeat(np.cumsum([0, *sizes[:-1]]), [len(part) for part in parts])
