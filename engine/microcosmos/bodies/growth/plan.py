"""Body plans: genes of segments, random ones, and the bodies that grow from them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

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
    """True if there is a mirror image on the other side of the parent."""
    copies: Any
    """Copies: evenly along an open parent up to `place`, around a ring or the root's base."""
    closed: Any
    """True if the segment is a ring that returns to its base."""


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


class Limb(NamedTuple):
    """Grown copies of segments, one row each."""

    gene: Any
    start: Any
    """First node that the copy added."""
    base: Any
    """Node that it is attached to."""
    nodes: Any


class Grown(NamedTuple):
    """A grown body; positions are in cells, relative to the first node."""

    present: Any
    """(node,)"""
    positions: Any
    """(node, 2)"""
    before: Any
    """(node,) the node before it on the way to the first node."""
    heading: Any
    """(node,) direction of the edge that leads to it, in rad."""
    hand: Any
    """(node,) −1 in mirror images, otherwise 1."""
    side: Any
    """(node,) −1, 0 or 1: the side of the limb that the node belongs to."""
    limb: Any
    """(node,) number of the copy, from −1 to 1; 0 where there is one."""
    along: Any
    """(node,) place along its segment, from −1 to 1."""
    distance: Any
    """(node, node) along the body, in spacings."""
    stiffness: Any
    """(node,) of the joint between its edge and the one before."""
    degree: Any
    """(node,) number of edges."""
    ring_base: Any
    """(ring,) the node at which a ring begins and ends."""
    ring_first: Any
    """(ring,) the first node behind it; −1: no ring."""
    ring_last: Any
    """(ring,)"""
    ungrown: Any
    """Number of genes without room to grow."""


class State(NamedTuple):
    """Growth after some genes."""

    grown: Grown
    limbs: Limb
    first: Any
    """(gene,) row of the first copy of a gene."""
    copies: Any
    """(gene,) number of copies that have grown."""
    nodes: Any
    rings: Any


SEGMENT_DRAWS = 12
"""Uniform numbers that a random segment takes."""
FIRST_LIMBS = 2
"""Most limbs of a random plan; they and the root have the numbers 0, 1 and 2."""
PLAN_DRAWS = 3 + FIRST_LIMBS * (1 + SEGMENT_DRAWS)
"""Uniform numbers that a random plan takes."""
LIMB_NODES = (LEAST_LIMB, 10)
ROOT_NODES = (LEAST_ROOT, 20)
"""Least and most nodes of random segments."""


@dataclass(frozen=True)
class Segments:
    """Limits of the genes of segments."""

    rows: int
    """Most segments of a plan."""
    nodes: int
    """Most nodes of a segment, at least `LEAST_ROOT`."""
    copies: int
    """Most copies of a segment along its parent."""


def random_plan(uniform: Any, limits: Segments, xp: Any = np) -> Plan:
    """Return a random plan: a root, in 3 of 4 cases with a limb, in half of these with two.

    `uniform` are `PLAN_DRAWS` uniform numbers.
    """
    own, rest = uniform[:3], uniform[3:].reshape(FIRST_LIMBS, 1 + SEGMENT_DRAWS)
    rows = [_root(own, limits, xp)]
    exists = xp.asarray(True)
    for number in range(1, min(limits.rows, 1 + FIRST_LIMBS)):
        draws = rest[number - 1]
        # Used rows come first, so that a second limb needs a first one.
        exists = exists & (draws[0] < (0.75 if number == 1 else 0.5))
        limb = random_segment(draws[1:], xp.asarray(number, np.int32), limits, xp)
        limb = limb._replace(number=xp.asarray(number, np.int32))
        rows.append(Plan(*(xp.where(exists, gene, xp.zeros_like(gene)) for gene in limb)))
    none = [Plan(*(xp.zeros_like(gene) for gene in rows[0]))] * (limits.rows - len(rows))
    return Plan(*(xp.stack(genes) for genes in zip(*rows, *none, strict=True)))


def random_segment(uniform: Any, rows: Any, limits: Segments, xp: Any = np) -> Plan:
    """Return a row of a new segment, attached to one of the first `rows`; it has no number.

    In half of all cases it begins at the base or the tip of its parent, else anywhere between.
    """
    low, high = LIMB_NODES
    end = xp.where(uniform[1] < 0.25, 0.0, 1.0)
    closed = uniform[10] < 0.12
    nodes = low + xp.floor(uniform[4] * (high - low + 1))
    nodes = xp.where(closed, xp.maximum(nodes, LEAST_RING), nodes)
    return _row(
        xp,
        parent=xp.floor(uniform[0] * rows),
        place=xp.where(uniform[1] < 0.5, end, uniform[2]),
        angle=2.4 * (2 * uniform[3] - 1),
        nodes=xp.minimum(nodes, limits.nodes),
        curl=2 * (uniform[5] + uniform[6] - 1),
        stiffness=uniform[11],
        mirrored=uniform[7] < 0.45,
        copies=xp.minimum(
            xp.where(uniform[8] < 0.7, 1, 2 + xp.floor(uniform[9] * 3)), limits.copies
        ),
        closed=closed,
    )


def _root(uniform: Any, limits: Segments, xp: Any) -> Plan:
    low, high = ROOT_NODES
    return _row(
        xp,
        nodes=xp.minimum(low + xp.floor(uniform[0] * (high - low + 1)), limits.nodes),
        curl=2 * uniform[1] - 1,
        stiffness=uniform[2],
    )._replace(number=xp.asarray(0, np.int32))


TYPES = {
    "used": np.bool_,
    "number": np.int32,
    "parent": np.int32,
    "place": np.float32,
    "angle": np.float32,
    "nodes": np.int32,
    "curl": np.float32,
    "stiffness": np.float32,
    "mirrored": np.bool_,
    "copies": np.int32,
    "closed": np.bool_,
}
"""Types of the genes of a segment."""


def _row(xp: Any, **genes: Any) -> Plan:
    usual = {name: 0 for name in TYPES} | {"used": True, "number": -1, "copies": 1}
    genes = usual | genes
    return Plan(*(xp.asarray(genes[name]).astype(kind) for name, kind in TYPES.items()))


def plan_of(columns: Mapping[str, Any], rows: int) -> Plan:
    """Return a plan of NumPy arrays with genes by name, and with room for `rows` segments."""
    count = len(columns["number"])
    genes = {name: np.zeros(rows, kind) for name, kind in TYPES.items()}
    genes["used"][:count] = True
    for name in Plan._fields[1:]:
        genes[name][:count] = columns[name]
    return Plan(**genes)
