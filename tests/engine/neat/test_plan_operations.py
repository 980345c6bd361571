"""Structural mutations of body plans: each changes what it says, and nothing else."""

from functools import cache, partial

import body_plans
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from body_plans import CAPACITY, LIMITS, to_jax

from microcosmos.bodies import growth
from microcosmos.neat import plans


@cache
def operator(operation):
    """The program of one structural mutation, with all numbers that it draws."""

    def run(plan, uniform, segment):
        count = jnp.sum(plan.used)
        which, other, amount = uniform
        return {
            "add": partial(plans._added, plan, count, segment, LIMITS),
            "split": partial(plans._split, plan, count, which, other),
            "remove": partial(plans._removed, plan, which),
            "mirror": partial(plans._mirrored, plan, which),
            "repeat": partial(plans._repeated, plan, which, other, LIMITS),
            "close": partial(plans._closed, plan, which),
            "attach": partial(plans._attached, plan, which, other, amount),
        }[operation]()

    return jax.jit(jax.vmap(run))


def applied(operation, batch, seed=0):
    """Plans before and after an operation, and the row of the new segment of each."""
    random = np.random.default_rng(seed)
    many = len(batch.used)
    uniform = random.random((many, 3), np.float32)
    segment = random.random((many, 12), np.float32)
    return jax.device_get(operator(operation)(to_jax(batch), uniform, segment))


@pytest.fixture(scope="module")
def some():
    keys = jax.random.split(jax.random.key(11), 600)
    return jax.device_get(jax.jit(jax.vmap(lambda key: body_plans.mutated(key, 12)))(keys))


def test_split_keeps_the_shape(some):
    single = some._replace(copies=np.where(some.used, 1, 0).astype(np.int32))
    after, row = applied("split", single)
    assert (row >= 0).sum() > 100
    grow = jax.jit(jax.vmap(lambda plan: growth.grow(plan, CAPACITY, jnp, body_plans.loop)))
    bodies = [jax.device_get(grow(to_jax(one))) for one in (single, after)]
    shapes = 0
    for index in np.flatnonzero(row >= 0):
        new, before = body_plans.member(after, index), body_plans.member(single, index)
        cut = row[index] - 1
        assert new.used.sum() == before.used.sum() + 1
        assert new.nodes[cut] + new.nodes[cut + 1] == before.nodes[cut]
        assert new.nodes[cut] >= (growth.LEAST_LIMB if cut else growth.LEAST_ROOT)
        assert new.nodes[cut + 1] >= growth.LEAST_LIMB
        assert new.stiffness[cut + 1] == before.stiffness[cut]
        assert new.parent[cut + 1] == cut
        assert _parents(before).keys() | {-1} == _parents(new).keys()
        one, other = (body_plans.member(body, index) for body in bodies)
        if not other.ungrown:
            shapes += 1
            assert _apart(one, other) < 1e-3
    assert shapes > 50


def _parents(plan):
    """The number of the parent of each segment but the root, by its own."""
    rows = np.flatnonzero(plan.used)[1:]
    return {int(plan.number[row]): int(plan.number[plan.parent[row]]) for row in rows}


def _apart(one, other):
    """The largest distance from a node to the nearest of the other body."""
    a, b = (body.positions[body.present] for body in (one, other))
    assert len(a) == len(b)
    gap = np.linalg.norm(a[:, None] - b[None], axis=-1)
    return max(gap.min(0).max(), gap.min(1).max())
