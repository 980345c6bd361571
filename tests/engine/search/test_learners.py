"""Emitters that learn by gradients, and Adam."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.genomes import Vector
from microcosmos.search import emitters, folding

GENES, SLOTS, CELLS = 12, 8, 100
KEYS = jax.random.split(jax.random.key(7), SLOTS)


def mega(**changes):
    def newcomer(*, key):
        return Vector(jax.random.uniform(key, (GENES,)))

    return emitters.CmaMega(slots=SLOTS, newcomer=newcomer, outputs=3, **changes)


def archive(genotype, occupied):
    none = search.no_elites(CELLS, len(search.MEASURES), genotype)
    first = jax.tree.map(lambda x, one: x.at[0].set(one), none.genotypes, genotype)
    return replace(none, occupied=none.occupied.at[0].set(occupied), genotypes=first)


def emitted(emitter, state, elites):
    emit = jax.jit(lambda *given: emitter.emit(*given, keys=KEYS)[:2])
    return emit(state, elites)


def slopes(rows, finite=True):
    return search.Slopes(jnp.asarray(rows, jnp.float32)[None], jnp.asarray([finite]))


@pytest.mark.long
def test_children_of_cma_mega_are_theta_and_combinations_of_unit_slopes():
    emitter, theta = mega(), jnp.full(GENES, 0.1)
    children, state = emitted(emitter, emitter.init(key=KEYS[0]), archive(Vector(theta), True))
    np.testing.assert_array_equal(emitter.to_differentiate(state, children).values, theta[None])
    rows = np.random.default_rng(0).normal(size=(3, GENES)) * [[10.0], [1.0], [0.1]]
    children, state = emitter.learn(state, children, slopes(rows))
    unit = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    expected = np.clip(0.1 + np.asarray(state.weights) @ unit, -1, 1)
    np.testing.assert_allclose(children.genotypes.values, expected, atol=1e-5)
    assert (state.weights[:, 0] >= 0).all()


@pytest.mark.long
def test_cma_mega_climbs_a_sphere(outcome_of):
    emitter, top = mega(step=0.2), np.linspace(-0.5, 0.5, GENES)
    state = emitter.init(key=KEYS[0])
    elites = archive(Vector(jnp.zeros(GENES)), True)
    best = -np.inf
    for generation in range(40):
        keys = jax.random.split(jax.random.key(generation), SLOTS)
        children, state, _ = emitter.emit(state, elites, keys=keys)
        way = 2 * (top - np.asarray(state.theta))
        rows = np.stack([way, *np.eye(GENES)[:2]])
        children, state = emitter.learn(state, children, slopes(rows))
        values = np.asarray(children.genotypes.values)
        fitness = -np.sum((values - top) ** 2, 1)
        entered = jnp.asarray(fitness > best)
        outcome = outcome_of(children.genotypes, fitness, entered=entered)
        state = emitter.tell(state, outcome)
        best = max(best, fitness.max())
        # Without this a step that overshoots would begin anew at the middle for ever.
        elites = archive(Vector(jnp.asarray(values[np.argmax(fitness)])), True)
    assert best > -0.02 * np.sum(top**2)


def test_cma_mega_restarts_if_nothing_enters_and_stays_if_slopes_are_invalid(outcome_of):
    emitter = mega()
    elites = archive(Vector(jnp.full(GENES, 0.2)), True)
    children, state = emitted(emitter, emitter.init(key=KEYS[0]), elites)
    children, state = emitter.learn(state, children, slopes(np.ones((3, GENES)), finite=False))
    np.testing.assert_allclose(children.genotypes.values, 0.2, atol=1e-7)
    nothing = {"entered": jnp.zeros(SLOTS, bool)}
    outcome = outcome_of(children.genotypes, np.zeros(SLOTS), **nothing)
    assert emitter.tell(state, outcome).restart


def test_means_are_those_of_the_paper(float64):
    slopes = np.random.default_rng(0).normal(size=(7, 4))
    state = folding.begin(jnp.zeros(4))
    for slope in slopes:
        change, state = folding.descend(state, jnp.asarray(slope), 0.01)
    weights = 0.9 ** np.arange(6, -1, -1), 0.999 ** np.arange(6, -1, -1)
    mean = weights[0] @ slopes / weights[0].sum()
    square = weights[1] @ slopes**2 / weights[1].sum()
    np.testing.assert_allclose(change, -0.01 * mean / (np.sqrt(square) + 1e-8), rtol=1e-9)
