"""The body plan of a creature as plain data, for programs that draw it."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees
from typing import Any

import numpy as np

from ...bodies.growth import Plan, State, plan_of, skeleton, sprout
from ...naming import decoded
from ..base import refuse
from ..body import GrownBody


@dataclass(frozen=True)
class PlanNode:
    """A node at rest, in cells from the middle of the body."""

    x: float
    y: float
    segment: int
    """Row of its segment, from 0."""
    copy: int
    """Copy of the segment in the body, from 0, with mirror images and copies of its parents."""
    hand: int
    """−1 in mirror images, otherwise 1."""
    side: int
    """Side of the limb: 1, −1 in its mirror image, 0 for limbs without one."""


@dataclass(frozen=True)
class PlanSegment:
    """The genes of a segment, and how many copies of it have grown."""

    number: int
    """Innovation number."""
    parent: int | None
    """Row of the segment that it is attached to; None for the root."""
    place: float
    """Place on the parent, from its first node (0) to its last (1)."""
    angle: float
    """Direction at the base relative to the parent's, in degrees."""
    nodes: int
    curl: float
    """Angle from the first edge to the last, in degrees; without effect in a ring."""
    stiffness: float
    mirrored: bool
    copies: int
    """Copies along the parent."""
    ring: bool
    grown: int
    """Copies in the body; 0: there was no room."""


@dataclass(frozen=True)
class PlanDrawing:
    """A body at rest and the plan that it grew from."""

    nodes: list[PlanNode]
    edges: list[tuple[int, int]]
    """Pairs of rows of nodes. An edge belongs to the segment of the later one."""
    segments: list[PlanSegment]


def plan_drawing(identity: Mapping[str, Any]) -> PlanDrawing:
    """Grow the body of a parsed creature.

    Raises `ValueError` if the genes are no plan.
    """
    genome = identity["genome"]
    refuse(
        "plan" not in genome, "genome.encoding", f"must hold a plan, got {genome['encoding']!r}"
    )
    capacity = GrownBody.model_validate(identity["body"]).capacity
    plan = plan_of(decoded(genome["plan"]), capacity.segments)
    state = sprout(plan, capacity)
    bones = skeleton(state.grown, capacity)
    rows = range(int(plan.used.sum()))
    return PlanDrawing(
        nodes=_nodes(state),
        edges=[(int(a), int(b)) for a, b in bones.edges[bones.edge_present]],
        segments=[_segment(plan, row, int(state.copies[row])) for row in rows],
    )


def _nodes(state: State) -> list[PlanNode]:
    grown, limbs = state.grown, state.limbs
    count = int(grown.present.sum())
    segment, copy = np.zeros((2, count), int)
    for limb in range(int(state.copies.sum())):
        nodes = slice(limbs.start[limb], limbs.start[limb] + limbs.nodes[limb])
        segment[nodes], copy[nodes] = limbs.gene[limb], limb - state.first[limbs.gene[limb]]
    positions = grown.positions[:count]
    return [
        PlanNode(
            x=round(float(x), 3),
            y=round(float(y), 3),
            segment=int(segment[row]),
            copy=int(copy[row]),
            hand=int(grown.hand[row]),
            side=int(grown.side[row]),
        )
        for row, (x, y) in enumerate(positions - positions.mean(0))
    ]


def _segment(plan: Plan, row: int, grown: int) -> PlanSegment:
    return PlanSegment(
        number=int(plan.number[row]),
        parent=int(plan.parent[row]) if row else None,
        place=round(float(plan.place[row]), 3),
        angle=round(degrees(plan.angle[row]), 1),
        nodes=int(plan.nodes[row]),
        curl=round(degrees(plan.curl[row]), 1),
        stiffness=round(float(plan.stiffness[row]), 3),
        mirrored=bool(plan.mirrored[row]),
        copies=int(plan.copies[row]),
        ring=bool(plan.closed[row]),
        grown=grown,
    )
