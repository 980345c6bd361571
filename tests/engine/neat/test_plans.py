"""Variation of body plans: valid plans, what each operation does, crossover and distance."""

import body_plans
import jax
import numpy as np
import pytest
from body_plans import LIMITS, different, plan_of, to_jax

from microcosmos import neat
from microcosmos.bodies.growth import (
    LEAST_LIMB,
    LEAST_RING,
    LEAST_ROOT,
    TYPES,
    Plan,
    Segments,
)
from microcosmos.neat import plans

COEFFICIENTS = neat.Coefficients(1.0, 1.0, 0.5)
SMALL = Segments(rows=3, nodes=18, copies=2)
ADD, SPLIT = (plans.OPERATIONS.index(name) for name in ("add", "split"))
LIMITS_OF = {"many": LIMITS, "few": SMALL}


@pytest.fixture(
    scope="module", params=[400, pytest.param(2_000, marks=pytest.mark.long)], ids=str
)
def count(request):
    return request.param


@pytest.fixture(scope="module", params=LIMITS_OF)
def limits(request):
    return LIMITS_OF[request.param]


@pytest.fixture(scope="module")
def varied(count, limits):
    """Plans after 40 mutations, most of them structural."""
    rates = plans.PlanRates(limits, structure=0.8, values=0.4, vary=0.9)
    keys = jax.random.split(jax.random.key(7), count)
    vary = jax.jit(jax.vmap(lambda key: body_plans.mutated(key, 40, rates)))
    return jax.device_get(vary(keys))


def test_mutations_keep_plans_valid(varied, limits):
    rows = np.arange(limits.rows)[None]
    count = varied.used.sum(1)
    assert count.min() >= 1
    assert count.max() == limits.rows
    assert np.array_equal(varied.used, rows < count[:, None])
    assert {name: one.dtype for name, one in varied._asdict().items()} == TYPES
    earlier = (varied.parent >= 0) & (varied.parent < np.maximum(rows, 1))
    assert earlier[varied.used].all()
    assert (varied.number[:, 0] == 0).all()
    alone = np.where(varied.used, varied.number, -1 - rows)
    assert all(len(set(one)) == limits.rows for one in alone.tolist())
    for name, low, high in (
        ("place", 0, 1),
        ("angle", -3.1416, 3.1416),
        ("nodes", LEAST_LIMB, limits.nodes),
        ("curl", -plans.MOST_CURL, plans.MOST_CURL),
        ("stiffness", 0, 1),
        ("copies", 1, limits.copies),
    ):
        values = getattr(varied, name)[varied.used]
        assert low <= values.min(), name
        assert values.max() <= high, name
        assert len(np.unique(values)) > 1, name
    assert varied.nodes[:, 0].min() == LEAST_ROOT
    assert varied.nodes[varied.closed].min() == LEAST_RING
    assert not varied.mirrored[:, 0].any()
    assert (varied.copies[:, 0] == 1).all()
    for one in varied:
        assert not one[~varied.used].any()


def test_crossover_of_equal_plans_is_the_identity(varied):
    keys = jax.random.split(jax.random.key(3), len(varied.used))
    cross = jax.jit(jax.vmap(lambda plan, key: plans.crossover_plan(plan, plan, key=key)))
    for one, other in zip(cross(varied, keys), varied, strict=True):
        assert np.asarray(one).tobytes() == other.tobytes()


def test_a_child_has_the_structure_of_the_fitter_and_whole_segments_of_either(varied):
    keys = jax.random.split(jax.random.key(3), len(varied.used))
    other = Plan(*(np.roll(one, 1, 0) for one in varied))
    cross = jax.jit(jax.vmap(lambda a, b, key: plans.crossover_plan(a, b, key=key)))
    child = jax.device_get(cross(varied, other, keys))
    for name in ("used", "number", "parent"):
        assert np.array_equal(getattr(child, name), getattr(varied, name))
    genes = [name for name in Plan._fields if name not in ("used", "number", "parent")]
    taken = 0
    for row in range(len(keys)):
        one, a, b = (body_plans.member(batch, row) for batch in (child, varied, other))
        for place in np.flatnonzero(one.used):
            mine = [getattr(one, name)[place] for name in genes]
            match = np.flatnonzero(b.used & (b.number == a.number[place]))
            theirs = [[getattr(b, name)[m] for name in genes] for m in match]
            own = [getattr(a, name)[place] for name in genes]
            assert mine == own or mine in theirs
            taken += mine != own
    assert taken > 0


@pytest.mark.long
def test_the_distance_counts_unmatched_segments_and_the_genes_of_matching_ones():
    a = plan_of({"nodes": 4}, {"nodes": 3, "place": 0.5}, {"nodes": 3, "number": 5})
    b = plan_of({"nodes": 4}, {"nodes": 11, "place": 0.75, "mirrored": True})
    found = plans.plan_distance(to_jax(a), to_jax(b), COEFFICIENTS)
    unmatched, unlike = 1 / 3, (0.25 + 8 / 8 + 1) / 2
    np.testing.assert_allclose(found, unmatched + 0.5 * unlike, rtol=1e-6)


@pytest.fixture(scope="module")
def some():
    keys = jax.random.split(jax.random.key(11), 300)
    return jax.device_get(jax.jit(jax.vmap(lambda key: body_plans.mutated(key, 12)))(keys))


def test_a_structural_mutation_is_alone_and_has_a_novelty(some):
    rates = plans.PlanRates(LIMITS, structure=0.5, values=0.5, vary=1.0)
    keys = jax.random.split(jax.random.key(4), len(some.used))
    vary = jax.jit(jax.vmap(lambda plan, key: plans.mutate_plan(plan, rates, key=key)))
    after, varied = jax.device_get(vary(to_jax(some), keys))
    new, operation = varied.novelty.row >= 0, varied.novelty.operation
    assert 0.3 < varied.changed.mean() < 0.5  # Some find nothing to change.
    assert not (new & ~varied.changed).any()
    assert set(operation[new].tolist()) == {ADD, SPLIT}
    assert (operation[~new] == -1).all()
    assert (varied.novelty.of[~new] == -1).all()
    for index in np.flatnonzero(new):
        row, one = varied.novelty.row[index], body_plans.member(after, index)
        assert one.number[row] == -1
        assert varied.novelty.of[index] == one.number[one.parent[row]]
    steps = np.array(different(after, some))[~varied.changed]
    assert set().union(*steps) == set(plans.VALUES)
