"""Structural mutations of body plans: each changes what it says, and nothing else."""

from functools import cache, partial

import body_plans
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from body_plans import CAPACITY, LIMITS, different, plan_of, to_jax

from microcosmos.bodies import growth
from microcosmos.bodies.growth import Plan
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


def test_add_puts_a_segment_behind_all_others(some):
    after, row = applied("add", some)
    count = some.used.sum(1)
    full = count == LIMITS.rows
    assert np.array_equal(row, np.where(full, -1, count))
    assert np.array_equal(after.used.sum(1), np.where(full, count, count + 1))
    for index in range(len(row)):
        one, before = body_plans.member(after, index), body_plans.member(some, index)
        for a, b in zip(one, before, strict=True):
            assert np.array_equal(a[: count[index]], b[: count[index]])
    assert different(after, some) != [set()] * len(row)


def test_remove_is_the_inverse_of_add(some):
    """Where the removed segment is the added one, the last."""
    more, row = applied("add", some)
    random = np.random.default_rng(0)
    found = np.zeros(len(row), bool)
    for _ in range(40):
        uniform = random.random((len(row), 3), np.float32)
        less, _ = jax.device_get(operator("remove")(to_jax(more), uniform, _none(row)))
        same = [not names for names in different(less, some)]
        found |= np.array(same)
    assert found[row >= 0].mean() > 0.95


def test_remove_takes_a_segment_to_which_none_is_attached(some):
    after, _ = applied("remove", some)
    for index in range(len(some.used)):
        one, before = body_plans.member(after, index), body_plans.member(some, index)
        gone = set(before.number[before.used].tolist()) - set(one.number[one.used].tolist())
        assert len(gone) == min(1, before.used.sum() - 1)
        parents = _parents(before)
        assert not gone & set(parents.values())
        assert _parents(one) == {n: p for n, p in parents.items() if n not in gone}


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


def test_split_gives_each_part_its_share_and_its_limbs():
    whole = plan_of(
        {"nodes": 20, "curl": 1.9},
        {"nodes": 3, "place": 2 / 20, "angle": 1.5},
        {"nodes": 3, "place": 19 / 20, "angle": -1.5},
    )
    after, row = applied("split", Plan(*(one[None] for one in whole)))
    assert row[0] == 1
    one = body_plans.member(after, 0)
    first = one.nodes[0]
    np.testing.assert_allclose(one.curl[:2], [0.1 * (first - 1), 0.1 * (19 - first)], rtol=1e-5)
    np.testing.assert_allclose(one.angle[1], 0.1, rtol=1e-6)
    assert one.number.tolist()[:4] == [0, -1, 1, 2]
    assert one.parent.tolist()[:4] == [0, 0, 0, 1]
    np.testing.assert_allclose(one.place[2] * first, 2, rtol=1e-6)
    np.testing.assert_allclose(one.place[3] * (20 - first), 19 - first, rtol=1e-6)


CHANGES = {
    "mirror": {"mirrored"},
    "repeat": {"copies"},
    "close": {"closed", "nodes"},
    "attach": {"parent", "place"},
}


@pytest.mark.parametrize("operation", CHANGES)
def test_other_operations_change_one_segment(some, operation):
    after, row = applied(operation, some)
    assert (row == -1).all()
    names = different(after, some)
    assert set().union(*names) == CHANGES[operation]
    limbs = some.used.sum(1) > 1
    rows = np.array([(a != b) for a, b in zip(after, some, strict=True)]).any(0)
    assert rows.sum(1).max() == 1
    if operation in ("mirror", "close"):
        chosen = rows if operation == "close" else rows[limbs]
        assert (chosen.sum(1) == 1).all()
    if operation == "repeat":
        assert np.abs(after.copies - some.copies).max() == 1
    if operation == "close":
        shut = rows & after.closed
        assert after.nodes[shut].min() >= growth.LEAST_RING
        assert not (after.nodes != some.nodes)[rows & ~after.closed].any()
    else:
        assert not rows[:, 0].any()
        assert not rows[~limbs].any()


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


def _none(row):
    return np.zeros((len(row), 12), np.float32)
