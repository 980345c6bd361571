"""Bodies as they grow: their nodes, and the copies of segments that have grown."""

from typing import Any, NamedTuple


class Limb(NamedTuple):
    """Rows of grown copies of segments."""

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
