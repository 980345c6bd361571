"""The bandit that divides batches among emitters, and children of chosen emitters."""

from dataclasses import replace
from math import log, sqrt

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.device import array
from microcosmos.genomes import Vector, minimal
from microcosmos.search import emitters

ZETA = 0.05


def bandit(exploration=ZETA, window=50):
    return emitters.Bandit(window, exploration)


def test_most_slots_go_to_the_emitter_whose_children_enter():
    successful, other = bandit().slots([200, 200], [100, 40], 64)
    assert (successful, other) == (64, 0)
    # Beside an equal one it has half.
    assert bandit().slots([200, 200, 200], [40, 100, 100], 64) == (0, 32, 32)


def test_an_emitter_without_children_is_tried():
    first, silent = bandit().slots([640, 0], [320, 0], 64)
    assert first + silent == 64
    assert silent >= 1


def test_an_emitter_whose_children_never_entered_is_tried_again():
    """As soon as its uncertainty exceeds the share of children of the other that enter."""
    rate, many = 0.02, 10_000
    needed = ZETA**2 * log(many) / rate**2
    for few, again in ((round(0.8 * needed), True), (round(1.3 * needed), False)):
        _, slots = bandit().slots([many, few], [round(rate * many), 0], 16)
        assert (slots > 0) == again


def test_slots_level_the_upper_bounds():
    children, entered, batch = [400, 300, 350], [40, 33, 30], 2000
    slots = bandit(0.5).slots(children, entered, batch)
    counts = np.add(children, slots)
    bounds = np.divide(entered, children) + 0.5 * np.sqrt(log(counts.sum()) / counts)
    assert min(slots) > 0
    one_slot = 0.25 * sqrt(log(counts.sum())) / counts.min() ** 1.5
    assert np.ptp(bounds) < 2 * one_slot


@pytest.mark.parametrize("seed", range(20))
def test_parts_sum_to_the_batch_and_grow_with_success(seed):
    rng = np.random.default_rng(seed)
    count, batch = int(rng.integers(2, 6)), int(rng.integers(1, 200))
    children = rng.integers(0, 300, count)
    entered = rng.binomial(children, rng.uniform(0, 0.6, count))
    rule = bandit(float(rng.uniform(0, 1)))
    slots = rule.slots(children.tolist(), entered.tolist(), batch)
    assert sum(slots) == batch
    assert min(slots) >= 0
    better = np.minimum(entered + np.eye(count, dtype=int)[0], children)
    assert rule.slots(children.tolist(), better.tolist(), batch)[0] >= slots[0]
    # The order of the emitters matters for equal ones alone.
    bounds = set(zip(children.tolist(), entered.tolist(), strict=True))
    if len(bounds) == count and (children > 0).all() and rule.exploration > 0:
        turned = rule.slots(children[::-1].tolist(), entered[::-1].tolist(), batch)
        assert np.abs(np.subtract(turned[::-1], slots)).max() <= 1


def test_it_finds_the_better_emitter_and_follows_when_another_becomes_better():
    rng, rule, outcomes = np.random.default_rng(0), bandit(window=20), []
    shares = []
    for generation in range(160):
        chances = (0.3, 0.1) if generation < 80 else (0.1, 0.3)
        children, entered = np.sum(outcomes[-rule.window :], 0) if outcomes else ([0, 0],) * 2
        slots = rule.slots(list(map(int, children)), list(map(int, entered)), 32)
        outcomes.append((slots, rng.binomial(slots, chances)))
        shares.append(slots[0] / 32)
    assert np.mean(shares[10:80]) > 0.9
    assert np.mean(shares[120:]) < 0.1


def network(key):
    return minimal(key, 3, 2, 8, 12)


def of_networks():
    def newcomer(*, key):
        return network(key)

    rates = neat.Rates(0.6, 1.0, 0.05, 0.1, 0.3, 0.5, 0.25)
    one = emitters.Neat(6, newcomer, rates, 3, select="uniform")
    crossing = emitters.Neat(5, newcomer, rates, 3, crossover=0.5, select="tournament")
    return one, emitters.Random(5, newcomer), crossing


def of_vectors():
    def newcomer(*, key):
        return Vector(jax.random.uniform(key, (3,), minval=-1.0, maxval=1.0))

    line = emitters.IsoLine(6, newcomer, 0.05, 0.2)
    return line, emitters.Random(5, newcomer), emitters.IsoLine(5, newcomer, 0.1)


@pytest.fixture(params=["networks", "vectors"])
def several(request):
    """Three emitters, and an archive of four elites and an empty cell."""
    chosen = of_networks() if request.param == "networks" else of_vectors()
    keys = jax.random.split(jax.random.key(2), 5)
    genotypes = jax.jit(jax.vmap(lambda key: chosen[0].newcomer(key=key)))(keys)
    empty = search.no_elites(5, 1, jax.tree.map(lambda x: np.asarray(x)[0], genotypes))
    occupied = np.arange(5) != 2
    fitness = array(np.where(occupied, np.arange(5), -np.inf), np.float32)
    there = {"occupied": array(occupied), "curiosity": array(occupied, np.float32)}
    return chosen, replace(empty, genotypes=genotypes, fitness=fitness, **there)


def same(one, other):
    pairs = zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True)
    return all(np.array_equal(x, y) for x, y in pairs)


@pytest.mark.long
def test_children_are_those_of_fixed_slots_and_one_program_serves_every_choice(several):
    chosen, archive = several
    counters, generation, key = neat.first_counters(3, 2), jnp.asarray(4), jax.random.key(1)
    states, compiled = (None, None, None), []

    @jax.jit
    def emit_fixed():
        return search.emitters.emit(chosen, states, archive, counters, generation, key=key)

    fixed, _, after = emit_fixed()

    @jax.jit
    def emit(emitter):
        compiled.append(True)
        given = archive, counters, generation, emitter
        return search.emitters.emit_chosen(chosen, *given, key=key)

    children, reached = emit(jnp.asarray([0] * 6 + [1] * 5 + [2] * 5))
    assert same(children, fixed)
    assert same(reached, after)
    others, _ = emit(jnp.asarray([0] * 1 + [1] * 9 + [2] * 6))
    random = np.asarray(others.operator) == search.OPERATORS.index("random")
    assert random.tolist() == [False] + [True] * 9 + [False] * 6
    # The last slots are the same emitter's in both, so their genes differ by numbers alone.
    np.testing.assert_array_equal(others.parents[11:], children.parents[11:])
    assert len(compiled) == 1
