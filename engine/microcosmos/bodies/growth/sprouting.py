"""Growth: from the genes of a body plan to the nodes of a body.

A plan is a tree of segments. A segment is attached to a place on an earlier one, may be
mirrored about it, repeated along it, or closed into a ring. Segments grow in the order of their
genes. A segment for which there is no room does not grow, nor do those attached to it: growth
ends at the capacity, at the largest length, and where nodes would come too near to others. The
root is cut to the room there is. So every plan grows into a valid body.

The same code runs on NumPy, for drawings, and on JAX, for a batch of creatures in one compiled
program. Both give the same bits in single precision, without fused multiply-adds.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from .body import Grown, Limb, State
from .placing import Bases, New, bases_of, images_of, nodes_of
from .plan import LEAST_RING, Capacity, Plan

CLEARANCE = 2.0
"""Least distance of two nodes of a body at rest, in spacings."""
FOLDED = 0.4
"""The same as a share of their distance along the body, where that is short."""
MOST_EDGES = 6
"""Most edges of a node."""


def grow(plan: Plan, capacity: Capacity, xp: Any = np, loop: Callable | None = None) -> Grown:
    """Return the body of a plan of arrays of `xp`; `loop(count, step, state)` repeats."""
    return sprout(plan, capacity, xp, loop).grown


def sprout(plan: Plan, capacity: Capacity, xp: Any = np, loop: Callable | None = None) -> State:
    """Return the body of a plan, with the copies of each segment that have grown."""
    repeat = loop or _loop
    # Empty rows hold zeros, by which nothing can be divided.
    plan = plan._replace(nodes=xp.maximum(plan.nodes, 1), copies=xp.maximum(plan.copies, 1))
    plan = _rooted(plan, capacity, xp)
    state = _seed(plan, capacity, xp)
    return repeat(
        capacity.segments, lambda gene, state: _sprout(plan, capacity, gene, state, xp), state
    )


def _rooted(plan: Plan, capacity: Capacity, xp: Any) -> Plan:
    """Return the plan with a root for which there is room.

    It has no more nodes than fit, bends at most until its ends come near, and is open where it
    is too short or too long for a ring.
    """
    root = xp.arange(len(plan.used)) == 0
    longest = _steps(capacity)
    most = min(capacity.nodes - 2, 2 * longest) if capacity.rings else 0
    closed = plan.closed & (~root | ((plan.nodes >= LEAST_RING) & (plan.nodes <= most)))
    longest = xp.where(closed, capacity.nodes, min(capacity.nodes - 2, longest))
    nodes = xp.where(root, xp.minimum(plan.nodes, longest), plan.nodes).astype(np.int32)
    reals = plan.curl.dtype
    corners, joints = nodes.astype(reals) + 2.5, (nodes - 1).astype(reals)
    bent = xp.asarray(2 * np.pi, reals) * joints * (1 / corners)
    curl = xp.where(root, xp.clip(plan.curl, -bent, bent), plan.curl).astype(reals)
    return plan._replace(closed=closed, nodes=nodes, curl=curl)


def _steps(capacity: Capacity) -> int:
    """Return the most edges between two nodes along a body."""
    spacing, length = np.float32(capacity.spacing), np.float32(capacity.length)
    steps = int(length / spacing) + 1
    while np.float32(steps) * spacing > length:
        steps -= 1
    return steps


def _loop(count: int, step: Callable, state: State) -> State:
    for number in range(count):
        state = step(number, state)
    return state


def _seed(plan: Plan, capacity: Capacity, xp: Any) -> State:
    """Return a body of one node, from which the root sprouts."""
    nodes, rings, rows = capacity.nodes, capacity.rings, capacity.segments * capacity.limbs
    reals = plan.curl.dtype
    none, zero = xp.zeros(nodes, np.int32), xp.zeros(nodes, reals)
    number = xp.asarray(0, np.int32)
    grown = Grown(
        present=xp.arange(nodes) == 0,
        positions=xp.zeros((nodes, 2), reals),
        before=none,
        heading=zero,
        hand=xp.ones(nodes, reals),
        side=zero,
        limb=zero,
        along=zero - 1,
        distance=xp.zeros((nodes, nodes), reals),
        stiffness=zero,
        degree=none,
        ring_base=xp.zeros(rings, np.int32),
        ring_first=xp.full(rings, -1, np.int32),
        ring_last=xp.zeros(rings, np.int32),
        ungrown=number,
    )
    empty = xp.zeros(rows, np.int32)
    genes = xp.zeros(capacity.segments, np.int32)
    return State(grown, Limb(empty, empty, empty, empty), genes, genes, number + 1, number)


def _sprout(plan: Plan, capacity: Capacity, gene: Any, state: State, xp: Any) -> State:
    """Grow all copies of a gene if there is room for them."""
    used, root = plan.used[gene], xp.asarray(gene == 0)
    images = images_of(plan, gene, xp)
    parents = xp.where(root, 1, state.copies[plan.parent[gene]])
    count = parents * images.sides * images.copies
    bases = bases_of(plan, capacity, gene, state, images, xp)
    new = nodes_of(plan, capacity, gene, state, bases, count, xp)
    room = used & (count >= 1) & _fits(plan, capacity, gene, state, new, count, xp)
    joined = _joined(plan, capacity, gene, state, bases, new, count, xp)
    grown = Grown(*(xp.where(room, a, b) for a, b in zip(joined, state.grown, strict=True)))
    left = (state.grown.ungrown + (used & ~room)).astype(np.int32)
    grown = grown._replace(ungrown=left)
    length, filled = plan.nodes[gene], xp.sum(state.copies).astype(np.int32)
    row = xp.arange(len(state.limbs.gene), dtype=np.int32) - filled
    mine = room & (row >= 0) & (row < count)
    at = xp.clip(row, 0, capacity.limbs - 1)
    limbs = Limb(
        gene=xp.where(mine, gene, state.limbs.gene),
        start=xp.where(mine, state.nodes + at * length, state.limbs.start),
        base=xp.where(mine, bases.node[at], state.limbs.base),
        nodes=xp.where(mine, length, state.limbs.nodes),
    )
    here = xp.arange(capacity.segments) == gene
    return State(
        grown,
        limbs,
        first=xp.where(here, filled, state.first),
        copies=xp.where(here & room, count, state.copies),
        nodes=xp.where(room, state.nodes + count * length, state.nodes),
        rings=xp.where(room & plan.closed[gene], state.rings + count, state.rings),
    )


def _fits(plan, capacity: Capacity, gene, state: State, new: New, count, xp):
    """Return whether there is room for all copies of a gene."""
    length, closed = plan.nodes[gene], plan.closed[gene]
    present = state.grown.present | new.here
    pairs = new.here[:, None] & present[None]
    pairs = pairs & ~xp.eye(capacity.nodes, dtype=bool)
    spacing = xp.asarray(capacity.spacing, plan.curl.dtype)
    gaps = new.positions[:, None] - new.positions[None]
    gap = gaps[..., 0] * gaps[..., 0] + gaps[..., 1] * gaps[..., 1]
    needed = spacing * xp.minimum(CLEARANCE, FOLDED * new.distance).astype(plan.curl.dtype)
    clear = xp.all(~pairs | (gap >= needed * needed))
    short = xp.all(~pairs | (new.distance * spacing <= capacity.length))
    few = state.nodes + count * length <= capacity.nodes - 1
    rings = ~closed | ((state.rings + count <= capacity.rings) & (length >= LEAST_RING))
    degree = state.grown.degree + _attached(new, closed, xp)
    return (
        (count <= capacity.limbs) & few & rings & clear & short & xp.all(degree <= MOST_EDGES)
    )


def _attached(new: New, closed, xp):
    """Return how many edges each old node gains."""
    first = new.here & (new.steps == 1)
    node = xp.arange(len(first))
    found = xp.sum(first[:, None] & (new.base[:, None] == node[None]), 0)
    return (found * (1 + closed)).astype(np.int32)


def _joined(
    plan, capacity: Capacity, gene, state: State, bases: Bases, new: New, count, xp
) -> Grown:
    """Return the body with the new nodes."""
    old, here, reals = state.grown, new.here, plan.curl.dtype
    length, closed = plan.nodes[gene], plan.closed[gene]
    node = xp.arange(capacity.nodes, dtype=np.int32)
    before = xp.where(new.steps == 1, new.base, node - 1)
    last = here & (new.steps == length)
    degree = xp.where(here, 1 + (~last | closed), old.degree) + _attached(new, closed, xp)
    along = 2 * new.steps.astype(reals) * (1 / length.astype(reals)) - 1
    ring = xp.arange(capacity.rings, dtype=np.int32) - state.rings
    mine = closed & (ring >= 0) & (ring < count)
    copy = xp.clip(ring, 0, capacity.limbs - 1)
    start = state.nodes + ring * length

    def put(values, before):
        return xp.where(here, values, before).astype(before.dtype)

    return Grown(
        present=old.present | here,
        positions=new.positions,
        before=put(before, old.before),
        heading=put(new.heading, old.heading),
        hand=put(bases.hand[new.copy], old.hand),
        side=put(bases.side[new.copy], old.side),
        limb=put(bases.limb[new.copy], old.limb),
        along=put(along, old.along),
        distance=new.distance,
        stiffness=put(plan.stiffness[gene] * xp.ones(len(here), reals), old.stiffness),
        degree=degree.astype(old.degree.dtype),
        ring_base=xp.where(mine, bases.node[copy], old.ring_base).astype(np.int32),
        ring_first=xp.where(mine, start, old.ring_first).astype(np.int32),
        ring_last=xp.where(mine, start + length - 1, old.ring_last).astype(np.int32),
        ungrown=old.ungrown,
    )
