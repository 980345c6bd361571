"""Growth: turn the genes of a body plan into the nodes of a body.

A plan is a tree of segments. A segment is attached to a place on an earlier one, may be
mirrored about it, repeated along it, or closed into a ring. Segments grow in the order of their
genes. A segment for which there is no room does not grow, nor do those attached to it: growth
ends at the capacity, at the largest length, and where nodes would come too near to others. The
root is cut to the room there is. So every plan grows into a valid body.

The same code runs on NumPy, for drawings, and on JAX, for a batch of creatures in one compiled
program. Both give the same bits in single precision, without fused multiply-adds.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .plan import LEAST_RING, Capacity, Grown, Limb, Plan, State


class Images(NamedTuple):
    """The number of images of a segment on each copy of its parent."""

    sides: Any
    """2 with a mirror image, else 1."""
    copies: Any
    around: Any
    """True if the copies stand evenly around the base of the root."""


def images_of(plan, gene, xp) -> Images:
    """Return the images of a gene.

    At the base of any limb but the root all images would coincide, so there is one.
    """
    root, parent = xp.asarray(gene == 0), plan.parent[gene]
    reach = plan.nodes[parent].astype(plan.place.dtype)
    base = ~plan.closed[parent] & (xp.rint(plan.place[gene] * reach) == 0) & ~root
    around = base & (parent == 0) & (plan.copies[gene] > 1)
    one = xp.ones_like(plan.copies[gene])
    return Images(
        sides=xp.where(root | around, one, one + plan.mirrored[gene]),
        copies=xp.where(root | (base & ~around), one, plan.copies[gene]),
        around=around,
    )


class Bases(NamedTuple):
    """The bases of the copies of a gene, one row for each copy."""

    node: Any
    heading: Any
    hand: Any
    side: Any
    limb: Any


def bases_of(plan, capacity: Capacity, gene, state: State, images: Images, xp) -> Bases:
    """Return the bases of the copies of a gene, with the direction in which each begins."""
    grown, reals, limb = state.grown, plan.curl.dtype, xp.arange(capacity.limbs)
    sides, copies, _ = images
    root, parent = xp.asarray(gene == 0), plan.parent[gene]
    row = state.first[parent] + limb // (sides * copies)
    row = xp.clip(row, 0, len(state.limbs.gene) - 1)
    copy, image = limb // sides % copies, limb % sides
    length = state.limbs.nodes[row]
    # XLA multiplies by the reciprocal of a single number, so NumPy has to.
    part, reach = 1 / copies.astype(reals), length.astype(reals)
    share = (copy + 1).astype(reals) * part
    ring = plan.closed[parent]
    # Around a ring all copies are alike; along a filament they end at the place.
    evenly = copy.astype(reals) * (reach + 1) * part
    around = xp.floor(plan.place[gene] * reach + evenly).astype(np.int32)
    along = xp.rint(plan.place[gene] * share * reach).astype(np.int32)
    place = xp.where(ring, around % (length + 1), along)
    node = xp.where(place == 0, state.limbs.base[row], state.limbs.start[row] + place - 1)
    node = xp.where(root, 0, xp.clip(node, 0, capacity.nodes - 1))
    # At the base of a limb its own first edge gives the direction.
    ahead = xp.where(place == 0, state.limbs.start[row], node)
    ahead = xp.clip(ahead, 0, capacity.nodes - 1)
    hand = grown.hand[ahead] * xp.where(image == 1, -1, 1).astype(reals)
    turn = xp.asarray(2 * np.pi, reals) * (1 / (copies + 1).astype(reals))
    angle = xp.where(images.around, turn * (copy + 1).astype(reals), plan.angle[gene])
    # On a ring 0 is straight outwards; at its base, from the edge that leaves it.
    corner = xp.asarray(np.pi, reals) / (reach + 1)
    corner = xp.where(place == 0, -corner, corner)
    out = xp.where(ring & ~root, corner - xp.asarray(np.pi / 2, reals), 0).astype(reals)
    spread = (2 * copy - (copies - 1)).astype(reals)
    spread = spread * (1 / xp.maximum(copies - 1, 1).astype(reals))
    ahead_of = grown.heading[ahead] + grown.hand[ahead] * out
    return Bases(
        node=node.astype(np.int32),
        heading=xp.where(root, 0, ahead_of + hand * angle).astype(reals),
        hand=xp.where(root, 1, hand).astype(reals),
        side=xp.where(sides == 2, 1 - 2 * image, grown.side[ahead]).astype(reals),
        limb=xp.where(copies > 1, spread, grown.limb[ahead]).astype(reals),
    )


class New(NamedTuple):
    """Nodes of the copies of a gene, in the rows that they would have."""

    added: Any
    copy: Any
    steps: Any
    """Steps along the segment from its base, from 1."""
    base: Any
    positions: Any
    heading: Any
    distance: Any
    """(node, node) of all nodes, old and new."""


def nodes_of(plan, capacity: Capacity, gene, state: State, bases: Bases, count, xp) -> New:
    """Return the nodes that the copies of a gene would add."""
    grown, reals = state.grown, plan.curl.dtype
    length, closed = plan.nodes[gene], plan.closed[gene]
    slot = xp.arange(capacity.nodes, dtype=np.int32) - state.nodes
    is_new = (slot >= 0) & (slot < count * length)
    copy = xp.clip(slot // length, 0, capacity.limbs - 1)
    steps = slot % length + 1
    base = xp.where(is_new, bases.node[copy], xp.arange(capacity.nodes, dtype=np.int32))
    corners = (length + 1).astype(reals)
    bend = plan.curl[gene] / xp.maximum(length - 1, 1).astype(reals)
    turn = xp.where(closed, xp.asarray(2 * np.pi, reals) / corners, bend).astype(reals)
    hand = bases.hand[copy]
    # The middle of a ring lies in the direction of its base.
    aside = xp.where(closed, turn / 2 - xp.asarray(np.pi / 2, reals), 0).astype(reals)
    outset = bases.heading[copy] + hand * aside
    heading = outset + hand * turn * (steps - 1).astype(reals)
    chord = outset + hand * turn * ((steps - 1).astype(reals) / 2)
    # The sum of unit vectors that turn evenly: sin(n t / 2) / sin(t / 2) along their mean.
    # A straight segment would divide 0 by 0; below 10⁻⁵ rad float32 knows no difference.
    flat = xp.abs(turn) < 1e-5
    half = xp.where(flat, xp.asarray(1, reals), turn / 2).astype(reals)
    wide = sine(steps.astype(reals) * half, xp) * (1 / sine(half, xp))
    reach = xp.where(flat, steps.astype(reals), wide) * xp.asarray(capacity.spacing, reals)
    offset = reach[:, None] * xp.stack([cosine(chord, xp), sine(chord, xp)], 1)
    positions = xp.where(is_new[:, None], grown.positions[base] + offset, grown.positions)
    around = xp.where(closed, xp.minimum(steps, length + 1 - steps), steps).astype(reals)
    distance = _distances(grown, is_new, copy, steps, around, base, length, closed, xp)
    return New(is_new, copy, steps, base, positions, heading, distance)


def _distances(grown: Grown, is_new, copy, steps, around, base, length, closed, xp):
    """Return distances along the body between all nodes, old and new."""
    from_base = xp.where(is_new, around, 0)
    between = grown.distance[base][:, base] + from_base[:, None] + from_base[None]
    apart = xp.abs(steps[:, None] - steps[None])
    apart = xp.where(closed, xp.minimum(apart, length + 1 - apart), apart)
    # Within one copy the path need not pass through its base.
    same = is_new[:, None] & is_new[None] & (copy[:, None] == copy[None])
    return xp.where(same, apart.astype(grown.distance.dtype), between)


# Sine and cosine are our own, in single precision, so that NumPy and JAX give the same bits.
QUARTER = 1.5703125, 4.8375129699707031e-4, 7.54978995489188216e-8
"""A quarter turn in three parts, of which small multiples are exact (Cody and Waite)."""


def sine(x: Any, xp: Any) -> Any:
    """Return the sine of angles of a few turns, in rad."""
    return _of_quarter(x, 0, xp)


def cosine(x: Any, xp: Any) -> Any:
    """Return the cosine of angles of a few turns, in rad."""
    return _of_quarter(x, 1, xp)


def _of_quarter(x: Any, ahead: int, xp: Any) -> Any:
    """Return the sine of angles `ahead` by quarter turns, by the polynomials of Cephes."""
    # Constants of the array's type: NumPy and JAX promote Python's numbers differently.
    one = x.dtype.type if xp is np else (lambda number: xp.asarray(number, x.dtype))
    quarters = xp.round(x * one(0.63661977))
    near = x
    for part in QUARTER:
        near = near - quarters * one(part)
    z = near * near
    s = (one(-1.9515295891e-4) * z + one(8.3321608736e-3)) * z - one(1.6666654611e-1)
    s = s * z * near + near
    c = (one(2.443315711809948e-5) * z - one(1.388731625493765e-3)) * z
    c = (c + one(4.166664568298827e-2)) * z * z - one(0.5) * z + one(1)
    quarter = quarters.astype(np.int32) + ahead
    value = xp.where(quarter % 2 == 1, c, s)
    return xp.where(quarter % 4 >= 2, -value, value)


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

    The root gets no more nodes than fit, bends at most until its ends come near, and is opened
    if it is too short or too long for a ring.
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
    # In single precision, and by products, as `_fits` compares: a quotient may round up.
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
    # The larger body is made in any case, and kept only if it fits: arrays have fixed sizes.
    joined = _joined(plan, capacity, gene, state, bases, new, count, xp)
    grown = Grown(*(xp.where(room, a, b) for a, b in zip(joined, state.grown, strict=True)))
    left = (state.grown.ungrown + (used & ~room)).astype(np.int32)
    grown = grown._replace(ungrown=left)
    length, filled = plan.nodes[gene], xp.sum(state.copies).astype(np.int32)
    row = xp.arange(len(state.limbs.gene), dtype=np.int32) - filled
    filled_rows = room & (row >= 0) & (row < count)
    at = xp.clip(row, 0, capacity.limbs - 1)
    limbs = Limb(
        gene=xp.where(filled_rows, gene, state.limbs.gene),
        start=xp.where(filled_rows, state.nodes + at * length, state.limbs.start),
        base=xp.where(filled_rows, bases.node[at], state.limbs.base),
        nodes=xp.where(filled_rows, length, state.limbs.nodes),
    )
    of_gene = xp.arange(capacity.segments) == gene
    return State(
        grown,
        limbs,
        first=xp.where(of_gene, filled, state.first),
        copies=xp.where(of_gene & room, count, state.copies),
        nodes=xp.where(room, state.nodes + count * length, state.nodes),
        rings=xp.where(room & plan.closed[gene], state.rings + count, state.rings),
    )


def _fits(plan, capacity: Capacity, gene, state: State, new: New, count, xp):
    """Return True if there is room for all copies of a gene."""
    length, closed = plan.nodes[gene], plan.closed[gene]
    present = state.grown.present | new.added
    pairs = new.added[:, None] & present[None]
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
    """Return the number of edges that each old node gains."""
    first = new.added & (new.steps == 1)
    node = xp.arange(len(first))
    gained = xp.sum(first[:, None] & (new.base[:, None] == node[None]), 0)
    return (gained * (1 + closed)).astype(np.int32)  # A ring comes back to its base.


def _joined(
    plan, capacity: Capacity, gene, state: State, bases: Bases, new: New, count, xp
) -> Grown:
    """Return the body with the new nodes."""
    old, added, reals = state.grown, new.added, plan.curl.dtype
    length, closed = plan.nodes[gene], plan.closed[gene]
    node = xp.arange(capacity.nodes, dtype=np.int32)
    before = xp.where(new.steps == 1, new.base, node - 1)
    last = added & (new.steps == length)
    degree = xp.where(added, 1 + (~last | closed), old.degree) + _attached(new, closed, xp)
    along = 2 * new.steps.astype(reals) * (1 / length.astype(reals)) - 1
    ring = xp.arange(capacity.rings, dtype=np.int32) - state.rings
    new_rings = closed & (ring >= 0) & (ring < count)
    copy = xp.clip(ring, 0, capacity.limbs - 1)
    start = state.nodes + ring * length

    def put(values, before):
        return xp.where(added, values, before).astype(before.dtype)

    return Grown(
        present=old.present | added,
        positions=new.positions,
        before=put(before, old.before),
        heading=put(new.heading, old.heading),
        hand=put(bases.hand[new.copy], old.hand),
        side=put(bases.side[new.copy], old.side),
        limb=put(bases.limb[new.copy], old.limb),
        along=put(along, old.along),
        distance=new.distance,
        stiffness=put(plan.stiffness[gene] * xp.ones(len(added), reals), old.stiffness),
        degree=degree.astype(old.degree.dtype),
        ring_base=xp.where(new_rings, bases.node[copy], old.ring_base).astype(np.int32),
        ring_first=xp.where(new_rings, start, old.ring_first).astype(np.int32),
        ring_last=xp.where(new_rings, start + length - 1, old.ring_last).astype(np.int32),
        ungrown=old.ungrown,
    )
