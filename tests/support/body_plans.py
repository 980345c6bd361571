"""Body plans from their segments, random plans, and the bodies that grow from them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies
from microcosmos.bodies import growth
from microcosmos.neat import plans

LIMITS = growth.Segments(rows=8, nodes=24, copies=6)
CAPACITY = growth.Capacity(nodes=49, segments=8, rings=3, limbs=12, length=40.0)
RATES = plans.PlanRates(LIMITS, structure=0.7, values=0.3, vary=0.9)


def plan_of(*segments: dict[str, Any], rows: int = 8) -> growth.Plan:
    """Return the plan of these segments, the root first; genes left out are 0, or 1 copy."""
    genes = {name: np.zeros(rows, kind) for name, kind in growth.TYPES.items()}
    for row, segment in enumerate(segments):
        for name, value in ({"used": True, "number": row, "copies": 1} | segment).items():
            genes[name][row] = value
    return growth.Plan(**genes)


def to_jax(plan: growth.Plan) -> growth.Plan:
    return growth.Plan(*(jnp.asarray(one) for one in plan))


def member(batch: Any, index: int) -> Any:
    """Return one of a batch of plans or bodies."""
    return type(batch)(*(one[index] for one in batch))


def random_plan(key: Any, limits: growth.Segments = LIMITS) -> growth.Plan:
    return growth.random_plan(jax.random.uniform(key, (growth.PLAN_DRAWS,)), limits, jnp)


def mutated(key: Any, times: int, rates: plans.PlanRates = RATES) -> growth.Plan:
    """Return a random plan after so many mutations, each new segment with a new number."""
    first, later = jax.random.split(key)

    def step(time, plan):
        key = jax.random.fold_in(later, time)
        child, varied = plans.mutate_plan(plan, rates, key=key)
        new = jnp.arange(rates.limits.rows) == varied.novelty.row
        number = jnp.where(new, 1 + growth.FIRST_LIMBS + time, child.number)
        genes = zip(child._replace(number=number), plan, strict=True)
        return growth.Plan(*(one.astype(old.dtype) for one, old in genes))  # Not of 64 bits.

    return jax.lax.fori_loop(0, times, step, random_plan(first, rates.limits))


def developed(plan: growth.Plan, capacity: growth.Capacity = CAPACITY) -> tuple[Any, ...]:
    """Return a grown body, its skeleton, and its form."""
    grown = growth.grow(plan, capacity, jnp, loop)
    bones = growth.skeleton(grown, capacity, jnp, loop)
    given = grown.positions, bones.edges, grown.present, bones.edge_present
    return grown, bones, growth.form(*given, jnp)


def different(after: growth.Plan, before: growth.Plan) -> list[set[str]]:
    """Return the names of the genes that differ in each plan of a batch."""
    found = []
    for index in range(len(before.used)):
        one, other = member(after, index), member(before, index)
        pairs = zip(growth.Plan._fields, one, other, strict=True)
        found.append({name for name, a, b in pairs if (a != b).any()})
    return found


def in_numpy(
    plan: growth.Plan, capacity: growth.Capacity = CAPACITY
) -> tuple[growth.Grown, growth.Skeleton]:
    grown = growth.grow(plan, capacity)
    return grown, growth.skeleton(grown, capacity)


def graph(grown: growth.Grown, bones: growth.Skeleton) -> bodies.Body:
    """Return the present nodes, edges and joints as a body of any other builder."""
    node, edge = np.cumsum(grown.present) - 1, np.cumsum(bones.edge_present) - 1
    edges = node[bones.edges[bones.edge_present]]
    joints = edge[bones.joints[bones.bends]]
    positions = grown.positions[grown.present].astype(float)
    x, y = (positions[edges[:, 1]] - positions[edges[:, 0]]).T
    angle = np.arctan2(y, x)
    turn = angle[joints[:, 1]] - angle[joints[:, 0]]
    return bodies.Body(
        positions=positions,
        edges=edges,
        joints=joints,
        rest_length=np.hypot(x, y),
        rest_angle=turn - 2 * np.pi * np.round(turn / (2 * np.pi)),
        **dict.fromkeys(("stretch", "shear"), np.ones(len(edges))),
        bend=np.ones(len(joints)),
        arc=np.linspace(0, 1, len(positions)),
    )


def loop(count: int, step: Any, state: Any) -> Any:
    def kept(number, before):
        # JAX widens sums of whole numbers where it has 64 bits.
        after = step(number, before)
        return jax.tree.map(lambda one, old: one.astype(old.dtype), after, before)

    return jax.lax.fori_loop(0, count, kept, state)
