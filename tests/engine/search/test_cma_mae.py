"""The evolution strategy finds minima; thresholds of CMA-MAE follow what is found."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.genomes import Vector
from microcosmos.search import emitters
from microcosmos.search.emitters import matrix_adaptation as es


def minimise(function, start, children, generations, sigma=0.3, seed=0):
    strategy = es.Strategy(len(start), children)

    def generation(distribution, key):
        values, z = es.draw(distribution, keys=jax.random.split(key, children))
        found = jax.vmap(function)(values)
        order = jnp.argsort(found)
        return es.update(distribution, z, order, strategy), jnp.min(found)

    keys = jax.random.split(jax.random.key(seed), generations)
    return jax.lax.scan(generation, es.start(jnp.asarray(start), sigma), keys)


def test_a_sphere_is_descended_at_the_rate_of_the_method(float64):
    # log-linear; Hansen (2016, fig. 5) needs some 1,500 evaluations for 1e-9 in 10 dimensions.
    _, best = minimise(lambda x: jnp.sum(x * x), np.full(10, 0.5), 10, 200)
    assert best.min() < 1e-9


def test_an_ellipsoid_of_condition_a_million_is_learnt(float64):
    scales = 10.0 ** (6 * np.arange(8) / 7)
    end, best = minimise(lambda x: jnp.sum(scales * x * x), np.full(8, 0.5), 10, 800)
    assert best.min() < 1e-8
    # M Mᵀ has become the inverse Hessian, up to a factor.
    covariance = np.asarray(end.m @ end.m.T)
    levels = np.diag(covariance) * scales
    assert levels.max() / levels.min() < 30


def test_turning_the_problem_turns_the_search(float64):
    scales, start = 10.0 ** np.arange(4), np.array([0.5, -0.3, 0.2, 0.1])
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(4, 4)))[0]
    strategy = es.Strategy(4, 8)
    straight, turned = (
        es.start(jnp.asarray(start), 0.3),
        es.start(jnp.asarray(turn @ start), 0.3),
    )
    for z in jnp.asarray(np.random.default_rng(3).normal(size=(30, 8, 4))):
        values = straight.mean[None] + straight.sigma * z @ straight.m.T
        order = jnp.argsort(jnp.sum(scales[None] * values**2, 1))
        straight = es.update(straight, z, order, strategy)
        z = z @ turn.T
        values = turned.mean[None] + turned.sigma * z @ turned.m.T
        order = jnp.argsort(jnp.sum(scales[None] * (values @ turn) ** 2, 1))
        turned = es.update(turned, z, order, strategy)
    np.testing.assert_allclose(turned.mean, turn @ straight.mean, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(turned.sigma, straight.sigma, rtol=1e-9)


def test_weights_are_of_the_better_half_and_sum_to_one():
    for children in (1, 2, 3, 10, 64):
        weights = es.Strategy(5, children).weights
        assert weights.sum() == pytest.approx(1)
        assert (np.diff(weights) <= 0).all()
        assert len(weights) == max(1, children // 2)


@pytest.fixture
def emitter():
    """A function that makes an emitter of six slots over four cells and two genes."""

    def make(**changes):
        options = {"cells": 4, "step": 0.2, "learning_rate": 0.3, "threshold": 1.0}
        newcomer = lambda *, key: Vector(jnp.zeros(2))  # noqa: E731
        return emitters.CmaMae(slots=6, newcomer=newcomer, **(options | changes))

    return make


def outcome(fitness, cell, sound=None):
    fitness, cell = jnp.asarray(fitness), jnp.asarray(cell)
    flags = jnp.ones(6, bool) if sound is None else jnp.asarray(sound)
    return search.Outcome(
        genotypes=Vector(jnp.zeros((6, 2))),
        fitness=fitness,
        measures=jnp.zeros((6, 1)),
        sound=flags,
        cell=jnp.where(flags, cell, 4),
        entered=flags,
        fresh=flags,
        improvement=fitness,
    )


def told(emitter, *given, **options):
    state = emitter.init(key=jax.random.key(0))
    z = jax.random.normal(jax.random.key(1), (6, 2))
    return emitter.tell(replace(state, z=z), outcome(*given, **options))


def test_thresholds_follow_what_was_found_above_them(emitter):
    found = told(emitter(), [2.0, 2.0, 2.0, 0.5, 3.0, 4.0], [0, 0, 0, 0, 1, 2])
    # One after another, t ← t + 0.3 (f − t), which for equal fitness is the batch's rule.
    first = 1.0
    for _ in range(3):
        first += 0.3 * (2.0 - first)
    expected = [first, 1 + 0.3 * 2, 1 + 0.3 * 3, 1.0]
    np.testing.assert_allclose(found.thresholds, expected, rtol=1e-6)


@pytest.mark.parametrize(("rate", "expected"), [(0.0, 1.0), (1.0, 2.5)])
def test_a_threshold_stays_or_is_replaced_at_the_ends_of_the_rate(emitter, rate, expected):
    found = told(emitter(learning_rate=rate), [2.0, 3.0, 0.0, 0.0, 0.0, 0.0], [0] * 6)
    np.testing.assert_allclose(found.thresholds, [expected, 1, 1, 1])


def test_what_diverged_counts_last_and_moves_no_threshold(emitter):
    fitness = [np.nan, np.inf, 3.0, 2.0, 1.5, 1.2]
    sound = [False, False, True, True, True, True]
    found = told(emitter(), fitness, [0, 0, 1, 1, 2, 3], sound=sound)
    assert np.isfinite(found.thresholds).all()
    assert np.isfinite(found.distribution.mean).all()
    assert found.thresholds[0] == 1.0


def test_a_spent_distribution_begins_anew_at_an_elite(emitter):
    chosen = emitter()
    state = chosen.init(key=jax.random.key(0))
    spent = replace(state.distribution, sigma=jnp.float32(1e-30), mean=jnp.full(2, 0.5))
    assert es.spent(spent)
    after = chosen.tell(replace(state, distribution=spent), outcome(np.arange(6.0), [0] * 6))
    assert after.restart
    archive = search.no_elites(4, 1, Vector(jnp.zeros(2)))
    elite = archive.genotypes.values.at[2].set(jnp.asarray([0.7, -0.1]))
    archive = search.Elites(
        **{
            **vars(archive),
            "occupied": archive.occupied.at[2].set(True),
            "genotypes": Vector(elite),
        }
    )
    keys, counters = jax.random.split(jax.random.key(0), 6), neat.first_counters(1, 1)
    children, again, _ = chosen.emit(after, archive, counters, keys=keys)
    np.testing.assert_allclose(again.distribution.mean, [0.7, -0.1], rtol=1e-6)
    assert not again.restart
    assert np.abs(children.genotypes.values).max() <= 1
