"""Emitters: their offspring and parents, and the evolution strategy of CMA-MAE."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.device import array
from microcosmos.genomes import Vector, minimal
from microcosmos.search import emitters
from microcosmos.search.emitters import matrix_adaptation as es

SLOTS, GENES = 2000, 3


def vector(key):
    return Vector(jax.random.uniform(key, (GENES,), minval=-1.0, maxval=1.0))


def network(key):
    return minimal(key, 3, 2, 8, 12)


@pytest.fixture
def archive():
    """A function that makes an archive of five cells from some elites, the rest empty."""

    def make(genotypes, cells):
        prototype = jax.tree.map(lambda x: np.asarray(x)[0], genotypes)
        empty = search.no_elites(5, 1, prototype)

        def placed(old, new):
            whole = np.array(old)
            whole[cells] = new
            return array(whole)

        return replace(
            empty,
            genotypes=jax.tree.map(placed, empty.genotypes, genotypes),
            occupied=placed(empty.occupied, True),
            fitness=placed(empty.fitness, np.arange(len(cells))),
        )

    return make


def emitted(emitter, archive, seed=0):
    @jax.jit
    def emit(state, archive, counters):
        given = ((emitter,), (state,), archive, counters, jnp.asarray(1))
        return search.emitters.emit(*given, key=jax.random.key(seed))

    state = emitter.init(key=jax.random.key(1))
    children, _, counters = emit(state, archive, neat.first_counters(3, 2))
    return children, counters


def test_a_gaussian_step_has_the_requested_deviation_within_the_bounds(archive):
    elite = Vector(jnp.asarray([[0.1, -0.2, 0.0]]))
    children, _ = emitted(emitters.IsoLine(SLOTS, vector, iso=0.05), archive(elite, [3]))
    steps = np.asarray(children.genotypes.values) - np.asarray(elite.values)
    np.testing.assert_allclose(steps.std(0), 0.05, rtol=0.06)
    np.testing.assert_allclose(steps.mean(0), 0.0, atol=0.005)
    assert (np.asarray(children.parents) == [3, search.NO_PARENT]).all()
    # Genes stay within their bounds.
    elite = Vector(jnp.asarray([[1.0, -1.0, 0.99]]))
    children, _ = emitted(emitters.IsoLine(SLOTS, vector, iso=1.0), archive(elite, [0]))
    assert np.abs(children.genotypes.values).max() <= 1.0


def test_children_of_a_line_lie_along_it(archive):
    ends = jnp.asarray([[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0]])
    emitter = emitters.IsoLine(SLOTS, vector, iso=0.001, line=0.2)
    children, _ = emitted(emitter, archive(Vector(ends), [0, 4]))
    values, parents = np.asarray(children.genotypes.values), np.asarray(children.parents)
    apart = parents[:, 0] != parents[:, 1]
    assert 0.45 < apart.mean() < 0.55
    from_first = np.where(parents[:, 0] == 0, 0.3, -0.3)
    along = (values[:, 0] - from_first)[apart]
    np.testing.assert_allclose(along.std(), 0.2 * 0.6, rtol=0.08)
    np.testing.assert_allclose(values[:, 1:].std(), 0.001, rtol=0.06)


@pytest.mark.long
@pytest.mark.parametrize("crossover", [0.0, 0.5])
def test_the_requested_share_of_children_has_two_parents(archive, crossover):
    networks = jax.jit(jax.vmap(network))(jax.random.split(jax.random.key(2), 4))
    rates = neat.Rates(0.6, 1.0, 0.05, 0.1, 0.02, 0.15, 0.25)
    emitter = emitters.Neat(SLOTS, lambda *, key: network(key), rates, 3, crossover)
    children, counters = emitted(emitter, archive(networks, [0, 1, 2, 4]))
    parents, operator = np.asarray(children.parents), np.asarray(children.operator)
    two = parents[:, 1] != search.NO_PARENT
    # A quarter of the second draws find the first parent again.
    assert abs(two.mean() - 0.75 * crossover) < 0.04
    assert (operator[two] == search.OPERATORS.index("crossover")).all()
    assert (operator[~two] == search.OPERATORS.index("neat")).all()
    assert set(parents[:, 0].tolist()) == {0, 1, 2, 4}
    assert int(counters.innovation) > 6


def test_all_children_of_an_empty_archive_are_newcomers(archive):
    nobody = archive(Vector(jnp.zeros((1, GENES))), [0])
    nobody = replace(nobody, occupied=jnp.zeros(5, bool))
    mixed = emitters.IsoLine(64, lambda *, key: vector(key), 0.1, 0.2, "mixed")
    children, _ = emitted(mixed, nobody)
    assert (np.asarray(children.parents) == search.NO_PARENT).all()
    assert (np.asarray(children.operator) == search.OPERATORS.index("random")).all()
    assert len(np.unique(children.genotypes.values, axis=0)) == 64


def minimise(function, start, children, generations, sigma=0.3, seed=0):
    strategy = es.strategy(len(start), children)

    def generation(distribution, key):
        values, z = es.draw(distribution, keys=jax.random.split(key, children))
        found = jax.vmap(function)(values)
        order = jnp.argsort(found)
        return es.update(distribution, z, order, strategy), jnp.min(found)

    @jax.jit
    def descend(start, key):
        keys = jax.random.split(key, generations)
        return jax.lax.scan(generation, es.start(start, sigma), keys)

    return descend(start, jax.random.key(seed))


def test_a_sphere_is_descended_at_the_rate_of_the_method(float64):
    # log-linear; Hansen (2016, fig. 5) needs some 1,500 evaluations for 1e-9 in 10 dimensions.
    _, best = minimise(lambda x: jnp.sum(x * x), np.full(10, 0.5), 10, 200)
    assert best.min() < 1e-9


def test_an_ellipsoid_of_condition_a_million_is_learnt(float64):
    scales = 10.0 ** (6 * np.arange(8) / 7)
    end, best = minimise(lambda x: jnp.sum(scales * x * x), np.full(8, 0.5), 10, 800)
    assert best.min() < 1e-8
    # M Mᵀ has become the inverse Hessian, up to a factor.
    m = np.asarray(end.m)
    covariance = m @ m.T
    levels = np.diag(covariance) * scales
    assert levels.max() / levels.min() < 30


@pytest.fixture
def emitter():
    def newcomer(*, key):
        return Vector(jnp.zeros(2))

    def make(**changes):
        options = {"cells": 4, "step": 0.2, "learning_rate": 0.3, "threshold": 1.0}
        return emitters.CmaMae(slots=6, newcomer=newcomer, **(options | changes))

    return make


@pytest.fixture
def state_after(outcome_of):
    """A function that gives an emitter's state after an outcome of six children."""

    def tell(emitter, fitness, cell, feasible=(True,) * 6, **changes):
        state = emitter.init(key=jax.random.key(0))
        z = jax.random.normal(jax.random.key(1), state.z.shape)
        flags = dict.fromkeys(("feasible", "entered", "fresh"), array(feasible))
        place = array(np.where(feasible, cell, 4))
        outcome = outcome_of(Vector(array(np.zeros((6, 2)))), fitness, cell=place, **flags)
        return jax.jit(emitter.tell)(replace(state, **{"z": z} | changes), outcome)

    return tell


def test_thresholds_follow_fitness_above_them_at_the_learning_rate(emitter, state_after):
    found = state_after(emitter(), [2.0, 2.0, 2.0, 0.5, 3.0, 4.0], [0, 0, 0, 0, 1, 2])
    # One after another, t ← t + 0.3 (f − t), which for equal fitness is the batch's rule.
    first = 1.0
    for _ in range(3):
        first += 0.3 * (2.0 - first)
    expected = [first, 1 + 0.3 * 2, 1 + 0.3 * 3, 1.0]
    np.testing.assert_allclose(found.thresholds, expected, rtol=1e-6)
    for rate, expected in ((0.0, 1.0), (1.0, 2.5)):
        found = state_after(
            emitter(learning_rate=rate), [2.0, 3.0, 0.0, 0.0, 0.0, 0.0], [0] * 6
        )
        np.testing.assert_allclose(found.thresholds, [expected, 1, 1, 1])


def test_infeasible_children_rank_last_and_move_no_threshold(emitter, state_after):
    fitness = [np.nan, np.inf, 3.0, 2.0, 1.5, 1.2]
    feasible = [False, False, True, True, True, True]
    found = state_after(emitter(), fitness, [0, 0, 1, 1, 2, 3], feasible=feasible)
    assert np.isfinite(found.thresholds).all()
    assert np.isfinite(found.distribution.mean).all()
    assert found.thresholds[0] == 1.0


def test_a_spent_distribution_begins_anew_at_an_elite(emitter, state_after):
    chosen = emitter()
    state = chosen.init(key=jax.random.key(0))
    spent = replace(state.distribution, sigma=jnp.full(1, 1e-30), mean=jnp.full((1, 2), 0.5))
    assert jax.jit(jax.vmap(es.must_restart))(spent).all()
    after = state_after(chosen, np.arange(6.0), [0] * 6, z=state.z, distribution=spent)
    assert after.restart
    archive = search.no_elites(4, 1, Vector(jnp.zeros(2)))
    elite = Vector(archive.genotypes.values.at[2].set(jnp.asarray([0.7, -0.1])))
    archive = replace(archive, occupied=archive.occupied.at[2].set(True), genotypes=elite)
    keys = jax.random.split(jax.random.key(0), 6)
    children, again, _ = jax.jit(chosen.emit)(after, archive, keys=keys)
    np.testing.assert_allclose(again.distribution.mean, [[0.7, -0.1]], rtol=1e-6)
    assert not again.restart
    assert np.abs(children.genotypes.values).max() <= 1


def test_strategies_share_thresholds_and_learn_from_their_own_children_alone(
    emitter, state_after
):
    fitness, cell = [2.0, 3.0, 2.5, 1.5, 1.2, 2.2], [0, 1, 2, 0, 1, 2]
    both, one = emitter(emitters=2), emitter()
    found = state_after(both, fitness, cell)
    np.testing.assert_array_equal(found.thresholds, state_after(one, fitness, cell).thresholds)
    z = jax.random.normal(jax.random.key(1), (2, 3, 2))
    for i, order in enumerate(([1, 2, 0], [2, 0, 1])):
        start = es.start(jnp.zeros(2), 0.2)
        update = jax.jit(lambda *given: es.update(*given, es.strategy(2, 3)))
        alone = update(start, z[i], np.array(order))
        for mine, other in zip(
            jax.tree.leaves(found.distribution), jax.tree.leaves(alone), strict=True
        ):
            np.testing.assert_allclose(mine[i], other, rtol=1e-6)
