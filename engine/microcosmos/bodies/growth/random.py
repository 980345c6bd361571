"""Random plans, from uniform numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .plan import LEAST_LIMB, LEAST_RING, LEAST_ROOT, Plan

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
    """Return a plan: a root, which most often has a limb, and that a second one.

    `uniform` are `PLAN_DRAWS` uniform numbers.
    """
    own, rest = uniform[:3], uniform[3:].reshape(FIRST_LIMBS, 1 + SEGMENT_DRAWS)
    rows = [_root(own, limits, xp)]
    there = xp.asarray(True)
    for number in range(1, min(limits.rows, 1 + FIRST_LIMBS)):
        draws = rest[number - 1]
        there = there & (draws[0] < (0.75 if number == 1 else 0.5))
        limb = random_segment(draws[1:], xp.asarray(number, np.int32), limits, xp)
        limb = limb._replace(number=xp.asarray(number, np.int32))
        rows.append(Plan(*(xp.where(there, gene, xp.zeros_like(gene)) for gene in limb)))
    none = [Plan(*(xp.zeros_like(gene) for gene in rows[0]))] * (limits.rows - len(rows))
    return Plan(*(xp.stack(genes) for genes in zip(*rows, *none, strict=True)))


def random_segment(uniform: Any, rows: Any, limits: Segments, xp: Any = np) -> Plan:
    """Return a row of a new segment, attached to one of the first `rows`; it has no number.

    It begins at the base or the tip of its parent as often as anywhere between.
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
    found = usual | genes
    return Plan(*(xp.asarray(found[name]).astype(kind) for name, kind in TYPES.items()))
