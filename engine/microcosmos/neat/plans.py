"""Variation of body plans: structure, numbers, crossover by alignment, and distance.

Segments are genes with innovation numbers, as connections are in NEAT (Stanley and Miikkulainen
2002). Every mutation of a valid plan gives a valid plan; what does not fit does not grow.
"""

from dataclasses import dataclass
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..bodies.growth import (
    LEAST_LIMB,
    LEAST_RING,
    LEAST_ROOT,
    SEGMENT_DRAWS,
    Plan,
    Segments,
    random_segment,
)
from .alignment import Coefficients
from .rows import NONE, Uniform, below, choose, draws, match, put, rescaled

OPERATIONS = ("add", "split", "remove", "mirror", "repeat", "close", "attach")
"""Structural mutations of a plan, by number."""
MOST_CURL = 6.0
"""Largest curl in rad."""
VALUES = ("place", "angle", "nodes", "curl", "stiffness")
"""Genes that vary by small steps."""


@dataclass(frozen=True)
class PlanRates:
    """Probabilities of changes to a plan, and the limits of its genes."""

    limits: Segments
    structure: float
    """A child's plan has a structural mutation."""
    vary: float
    """Numbers of a child's plan vary, if its structure does not."""
    values: float
    """Each of these numbers varies, if any do."""


class PlanNovelty(eqx.Module):
    """The new segment of a child, and the marks by which equal ones get equal numbers."""

    row: Int[Array, "*batch"]
    """Row of the new segment, or −1."""
    of: Int[Array, "*batch"]
    """Number of the segment that was split, or that the new one is attached to; −1: none."""
    operation: Int[Array, "*batch"]


class Varied(NamedTuple):
    """The outcome of a mutation of a plan."""

    novelty: PlanNovelty
    changed: Bool[Array, ""]
    """True if the structure differs."""


def mutate_plan(plan: Plan, rates: PlanRates, *, key: PRNGKeyArray) -> tuple[Plan, Varied]:
    """Return a varied plan, and its segment that needs a number."""
    limits, rows = rates.limits, rates.limits.rows
    decisions, segment, values = draws((6,), (SEGMENT_DRAWS,), (len(VALUES), rows), key=key)
    changes = decisions[0] < rates.structure
    operation = jnp.where(changes, below(jnp.asarray(len(OPERATIONS)), decisions[1]), NONE)
    varies = ~changes & (decisions[2] < rates.vary)
    count = jnp.sum(plan.used)
    which, other, amount = decisions[3:6]
    # Under `vmap` a branch computes all its cases anyway: all are made, and one is selected.
    candidates = (
        _added(plan, count, segment, limits),
        _split(plan, count, which, other),
        _removed(plan, which),
        _mirrored(plan, which),
        _repeated(plan, which, other, limits),
        _closed(plan, which),
        _attached(plan, which, other, amount),
    )
    child = _varied(plan, varies, rates.values, limits, values)
    row = jnp.asarray(NONE)
    for number, (changed, new) in enumerate(candidates):
        chosen = operation == number
        child = Plan(*(jnp.where(chosen, a, b) for a, b in zip(changed, child, strict=True)))
        row = jnp.where(chosen, new, row)
    # A new segment stands behind the one it is attached to, or split from.
    of = jnp.where(row >= 0, child.number[child.parent[row]], NONE)
    novelty = PlanNovelty(row, of, jnp.where(row >= 0, operation, NONE))
    # A root alone cannot be mirrored, nor a full plan split: such a child is like its parent.
    differs = [jnp.any(one != old) for one, old in zip(child, plan, strict=True)]
    return child, Varied(novelty, changes & jnp.any(jnp.stack(differs)))


def crossover_plan(fitter: Plan, other: Plan, *, key: PRNGKeyArray) -> Plan:
    """Return the fitter parent's structure, with matching segments' genes of either parent."""
    (uniform,) = draws((len(fitter.used),), key=key)
    row = match(fitter.number, fitter.used, other.number, other.used)
    taken = (row >= 0) & (uniform < 0.5)
    inherited = Plan(*(jnp.where(taken, b[row], a) for a, b in zip(fitter, other, strict=True)))
    return inherited._replace(used=fitter.used, number=fitter.number, parent=fitter.parent)


def plan_distance(a: Plan, b: Plan, coefficients: Coefficients) -> Float[Array, ""]:
    """Return NEAT's distance of plans.

    It is the share of unmatched segments in the larger plan, plus the mean difference of
    matching segments, each gene divided by its usual range.
    """
    row = match(a.number, a.used, b.number, b.used)
    unlike = (
        jnp.abs(a.place - b.place[row])
        + jnp.abs(_within_half_a_turn(a.angle - b.angle[row])) / jnp.pi
        + jnp.abs(a.nodes - b.nodes[row]) / 8
        + jnp.abs(a.curl - b.curl[row]) / jnp.pi
        + jnp.abs(a.stiffness - b.stiffness[row])
        + jnp.abs(a.copies - b.copies[row])
        + (a.number[a.parent] != b.number[b.parent[row]])
        + (a.mirrored != b.mirrored[row])
        + (a.closed != b.closed[row])
    )
    matching = jnp.sum(row >= 0)
    size_a, size_b = jnp.sum(a.used), jnp.sum(b.used)
    unmatched = coefficients.disjoint * (size_a + size_b - 2 * matching)
    mean = jnp.sum(jnp.where(row >= 0, unlike, 0.0)) / jnp.maximum(1, matching)
    return unmatched / jnp.maximum(1, jnp.maximum(size_a, size_b)) + coefficients.weight * mean


Change = tuple[Plan, Int[Array, ""]]
"""A changed plan, and the row of its new segment or −1."""


def _added(plan: Plan, count, uniform: Uniform, limits: Segments) -> Change:
    """Attach a random segment."""
    row = jnp.where(count < limits.rows, count, NONE)
    drawn = random_segment(uniform, count, limits, jnp)
    return Plan(*(put(column, row, one) for column, one in zip(plan, drawn, strict=True))), row


def _split(plan: Plan, count, which: Uniform, where: Uniform) -> Change:
    """Cut a segment in two; the second part keeps its course, but may now change alone.

    The body keeps its shape, but for copies along the segment, which crowd on one part.
    """
    rows = jnp.arange(len(plan.used))
    cut, first, exists = _place_to_cut(plan, which, where)
    exists = exists & (count < len(rows))
    whole = plan.nodes[cut]
    share = first / whole
    bend = plan.curl[cut] / jnp.maximum(whole - 1, 1)
    # Rows behind the cut one move down by one; the new segment takes the row behind it.
    source = jnp.where(rows > cut, rows - 1, rows)
    moved = Plan(*(column[source] for column in plan))
    moved = moved._replace(parent=moved.parent + (moved.parent > cut))
    behind, mine = rows == cut + 1, rows == cut
    # Growth rounds to the same node.
    beyond = jnp.rint(moved.place * whole) > first
    # Not over `share`: a quotient of a quotient is rounded in one way or another.
    before = jnp.minimum(1.0, moved.place * whole / first)
    later = (moved.parent == cut) & (rows > cut + 1) & beyond
    new = moved._replace(
        number=jnp.where(behind, -1, moved.number),
        parent=jnp.where(behind, cut, jnp.where(later, cut + 1, moved.parent)),
        place=jnp.where(
            behind,
            1.0,
            jnp.where(
                later,
                (moved.place - share) / (1 - share),
                jnp.where(moved.parent == cut, before, moved.place),
            ),
        ),
        angle=jnp.where(behind, bend, moved.angle),
        nodes=jnp.where(mine, first, jnp.where(behind, whole - first, moved.nodes)),
        curl=jnp.where(
            mine,
            bend * (first - 1),
            jnp.where(behind, bend * (whole - first - 1), moved.curl),
        ),
        mirrored=moved.mirrored & ~behind,
        copies=jnp.where(behind, 1, moved.copies),
    )
    # The root's own place has no meaning and stays.
    new = new._replace(place=new.place.at[0].set(plan.place[0]).astype(plan.place.dtype))
    split = Plan(*(jnp.where(exists, a, b) for a, b in zip(new, plan, strict=True)))
    return split, jnp.where(exists, cut + 1, NONE)


def _place_to_cut(
    plan: Plan, which: Uniform, where: Uniform
) -> tuple[Int[Array, ""], Int[Array, ""], Bool[Array, ""]]:
    """Draw a segment and the nodes of its first part; return also if any is long enough."""
    root = jnp.arange(len(plan.used)) == 0
    least = jnp.where(root, LEAST_ROOT, LEAST_LIMB)
    able = plan.used & ~plan.closed & (plan.nodes >= least + LEAST_LIMB)
    cut, exists = choose(able, which)
    middle = jnp.rint(plan.nodes[cut] * (0.3 + 0.4 * where)).astype(jnp.int32)
    return cut, jnp.clip(middle, least[cut], plan.nodes[cut] - LEAST_LIMB), exists


def _removed(plan: Plan, which: Uniform) -> Change:
    """Remove a segment to which none is attached."""
    rows = jnp.arange(len(plan.used))
    attached = jnp.any((plan.parent[:, None] == rows[None]) & _limbs(plan)[:, None], 0)
    row, exists = choose(_limbs(plan) & ~attached, which)
    source = jnp.where(rows >= row, rows + 1, rows)

    def shifted(column):
        longer = jnp.append(column, jnp.zeros(1, column.dtype))
        return jnp.where(exists, longer[source], column)

    moved = Plan(*(shifted(column) for column in plan))
    parent = moved.parent - (exists & (moved.parent > row))
    return moved._replace(parent=parent), jnp.asarray(NONE)


def _mirrored(plan: Plan, which: Uniform) -> Change:
    """Mirror a segment, or remove its mirror image."""
    row = _one_limb(plan, which)
    chosen = jnp.arange(len(plan.used)) == row
    return plan._replace(mirrored=plan.mirrored ^ chosen), jnp.asarray(NONE)


def _repeated(plan: Plan, which: Uniform, more: Uniform, limits: Segments) -> Change:
    """Add or remove a copy of a segment."""
    row = _one_limb(plan, which)
    copies = jnp.clip(plan.copies + jnp.where(more < 0.6, 1, -1), 1, limits.copies)
    chosen = jnp.arange(len(plan.used)) == row
    return plan._replace(copies=jnp.where(chosen, copies, plan.copies)), jnp.asarray(NONE)


def _closed(plan: Plan, which: Uniform) -> Change:
    """Close a segment into a ring, which may lengthen it, or open a ring."""
    row, _ = choose(plan.used, which)
    chosen = jnp.arange(len(plan.used)) == row
    longer = jnp.maximum(plan.nodes, LEAST_RING)
    nodes = jnp.where(chosen & ~plan.closed, longer, plan.nodes)
    return plan._replace(closed=plan.closed ^ chosen, nodes=nodes), jnp.asarray(NONE)


def _attached(plan: Plan, which: Uniform, to: Uniform, where: Uniform) -> Change:
    """Attach a segment elsewhere, to one that stands before it."""
    row = _one_limb(plan, which)
    chosen = jnp.arange(len(plan.used)) == row
    # Half of the draws attach at an end, which no uniform place would hit.
    end = jnp.where(where < 0.25, 0.0, jnp.where(where < 0.5, 1.0, rescaled(where, 0.5, 1.0)))
    parent = jnp.where(chosen, below(jnp.maximum(row, 1), to), plan.parent)
    place = jnp.where(chosen, end, plan.place).astype(plan.place.dtype)
    return plan._replace(parent=parent.astype(jnp.int32), place=place), jnp.asarray(NONE)


def _varied(
    plan: Plan, happens: Bool[Array, ""], rate: float, limits: Segments, uniform: Uniform
) -> Plan:
    """Vary some numbers of segments, each by a normal step."""
    columns = {}
    for name, draw in zip(VALUES, uniform, strict=True):
        chosen = happens & plan.used & (draw < rate)
        step = _step(rescaled(draw, 0.0, rate))
        column = getattr(plan, name)
        if name == "place":
            new = jnp.clip(column + 0.2 * step, 0.0, 1.0)
        elif name == "angle":
            new = _within_half_a_turn(column + 0.4 * step)
        elif name == "nodes":
            by = jnp.where(step < 0, -1, 1) * (1 + (jnp.abs(step) > 1.0))
            least = jnp.where(plan.closed, LEAST_RING, LEAST_LIMB).at[0].set(LEAST_ROOT)
            new = jnp.clip(column + by, least, limits.nodes)
        elif name == "curl":
            new = jnp.clip(column + 0.5 * step, -MOST_CURL, MOST_CURL)
        else:
            new = jnp.clip(column + 0.2 * step, 0.0, 1.0)
        columns[name] = jnp.where(chosen, new, column).astype(column.dtype)
    return plan._replace(**columns)


def _within_half_a_turn(angle: Float[Array, "..."]) -> Float[Array, "..."]:
    return angle - 2 * jnp.pi * jnp.round(angle / (2 * jnp.pi))


def _step(uniform: Uniform) -> Float[Array, "..."]:
    """Return a number with mean 0 and deviation 1 from a uniform one: the logistic quantile."""
    # The quantile is infinite at 0 and 1; the bounds keep steps below 5.1 deviations.
    inside = jnp.clip(uniform, 1e-4, 1 - 1e-4)
    return jnp.log(inside / (1 - inside)) * (jnp.sqrt(3.0) / jnp.pi)


def _limbs(plan: Plan) -> Bool[Array, "segment"]:
    """Select all segments but the root."""
    return plan.used & (jnp.arange(len(plan.used)) > 0)


def _one_limb(plan: Plan, which: Uniform) -> Int[Array, ""]:
    """Draw a segment that is not the root, or −1."""
    row, exists = choose(_limbs(plan), which)
    return jnp.where(exists, row, NONE)
