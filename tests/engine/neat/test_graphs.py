"""NEAT on genotypes of two parts: a plan and a network."""

from dataclasses import replace

import body_plans
import jax
import numpy as np
import pytest
from body_plans import LIMITS

from microcosmos import genomes, neat
from microcosmos.neat import graphs, plans
from microcosmos.neat.plans import PlanRates

INPUTS, OUTPUTS, BATCH = 3, 2, 200
RATES = replace(
    neat.PRESETS["paper"].rates,
    add_node=0.3,
    add_connection=0.4,
    plan=PlanRates(LIMITS, structure=0.4, values=0.3, vary=0.8),
)
COEFFICIENTS = neat.Coefficients(1.0, 1.0, 0.4)


@jax.jit
def newcomer(key):
    network = neat.minimal(key, INPUTS, OUTPUTS, 14, 40)
    return genomes.BodyGraph(body_plans.random_plan(key), network)


@jax.jit
def generation(parents, counters, key):
    """Children of all parents, what is new in them, and the next counters."""
    mutate = jax.vmap(lambda one, key: graphs.mutate(one, RATES, INPUTS, OUTPUTS, key=key))
    children, novelty = mutate(parents, jax.random.split(key, BATCH))
    numbered, counters = neat.number(children, novelty, counters)
    return numbered, novelty, counters


@pytest.fixture(scope="module")
def history():
    """Parents, children, novelty and counters of ten generations without selection."""
    now = jax.vmap(newcomer)(jax.random.split(jax.random.key(0), BATCH))
    counters, found = neat.first_counters(INPUTS, OUTPUTS), []
    for number in range(10):
        children, novelty, after = generation(now, counters, jax.random.key(number))
        found.append((now, children, novelty, counters, after))
        now, counters = children, after
    return jax.device_get(found)


def same(one, other):
    """Which genotypes of two batches are equal."""
    pairs = zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True)
    return np.array([(a == b).reshape(BATCH, -1).all(1) for a, b in pairs]).all(0)


def test_the_network_stays_where_the_structure_of_the_plan_changes(history):
    for parents, children, novelty, *_ in history:
        structure = [
            (getattr(parents.plan, name) != getattr(children.plan, name)).any(1)
            for name in ("used", "parent", "mirrored", "copies", "closed")
        ]
        changed = np.array(structure).any(0)
        kept = same(parents.network, children.network)
        assert kept[changed].all()
        assert kept[novelty.segment.row >= 0].all()
        assert not kept[~changed].all()
        assert (novelty.node_row[changed] == -1).all()


def test_a_new_segment_has_a_new_number_by_where_it_grew(history):
    for _, children, novelty, before, after in history:
        new = np.flatnonzero(novelty.segment.row >= 0)
        numbers = children.plan.number[new, novelty.segment.row[new]]
        assert numbers.min() >= before.segment
        assert numbers.max() < after.segment
        pairs = zip(novelty.segment.of[new], novelty.segment.operation[new], strict=True)
        who = [(int(of), int(way)) for of, way in pairs]
        known = dict(zip(who, numbers.tolist(), strict=True))
        assert [known[one] for one in who] == numbers.tolist()
        assert len(set(known.values())) == len(known) == after.segment - before.segment
        assert len(known) < len(new), "some mutations are equal"


def test_the_distance_is_the_sum_over_both_parts(history):
    genotypes = history[-1][1]
    other = jax.tree.map(lambda x: np.roll(x, 1, 0), genotypes)

    def measure(of, a, b):
        return np.asarray(jax.jit(jax.vmap(lambda a, b: of(a, b, COEFFICIENTS)))(a, b))

    whole = measure(graphs.distance, genotypes, other)
    bodies = measure(plans.plan_distance, genotypes.plan, other.plan)
    networks = measure(neat.distance, genotypes.network, other.network)
    np.testing.assert_allclose(whole, bodies + networks, rtol=1e-5)
    assert not measure(graphs.distance, genotypes, genotypes).any()
    assert bodies.min() >= 0
    assert (bodies > 0).any()
    assert (networks > 0).any()


def test_the_same_keys_give_the_same_bytes(history):
    parents, children, _, counters, _ = history[3]
    again, *_ = jax.device_get(generation(parents, counters, jax.random.key(3)))
    for one, other in zip(jax.tree.leaves(again), jax.tree.leaves(children), strict=True):
        assert one.tobytes() == other.tobytes()
