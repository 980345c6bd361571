"""Places of the copies of a segment: where they begin, and the nodes that they would add."""

from typing import Any, NamedTuple

import numpy as np

from .body import Grown, State
from .plan import Capacity
from .trigonometry import cosine, sine


class Images(NamedTuple):
    """How often a segment stands on each copy of its parent."""

    sides: Any
    """2 with a mirror image, else 1."""
    copies: Any
    around: Any
    """Whether the copies stand evenly around the base of the root."""


def images_of(plan, gene, xp) -> Images:
    """Return the images of a gene. At the base of any limb but the root all images would
    coincide, so there is one."""
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
    """Where the copies of a gene begin, one row for each copy."""

    node: Any
    heading: Any
    hand: Any
    side: Any
    limb: Any


def bases_of(plan, capacity: Capacity, gene, state: State, images: Images, xp) -> Bases:
    """Return where the copies of a gene begin."""
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

    here: Any
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
    here = (slot >= 0) & (slot < count * length)
    copy = xp.clip(slot // length, 0, capacity.limbs - 1)
    steps = slot % length + 1
    base = xp.where(here, bases.node[copy], xp.arange(capacity.nodes, dtype=np.int32))
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
    flat = xp.abs(turn) < 1e-5
    half = xp.where(flat, xp.asarray(1, reals), turn / 2).astype(reals)
    wide = sine(steps.astype(reals) * half, xp) * (1 / sine(half, xp))
    reach = xp.where(flat, steps.astype(reals), wide) * xp.asarray(capacity.spacing, reals)
    offset = reach[:, None] * xp.stack([cosine(chord, xp), sine(chord, xp)], 1)
    positions = xp.where(here[:, None], grown.positions[base] + offset, grown.positions)
    around = xp.where(closed, xp.minimum(steps, length + 1 - steps), steps).astype(reals)
    distance = _distances(grown, here, copy, steps, around, base, length, closed, xp)
    return New(here, copy, steps, base, positions, heading, distance)


def _distances(grown: Grown, here, copy, steps, around, base, length, closed, xp):
    """Return distances along the body between all nodes, old and new."""
    from_base = xp.where(here, around, 0)
    between = grown.distance[base][:, base] + from_base[:, None] + from_base[None]
    apart = xp.abs(steps[:, None] - steps[None])
    apart = xp.where(closed, xp.minimum(apart, length + 1 - apart), apart)
    same = here[:, None] & here[None] & (copy[:, None] == copy[None])
    return xp.where(same, apart.astype(grown.distance.dtype), between)
