"""The choice of candidates by expected gain."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.genomes import Vector
from microcosmos.search.screening import Predicted, best, expected_gain, heights


def predicted(fitness, cell, feasible=1.0, error=0.1):
    fitness = jnp.asarray(fitness, jnp.float32)
    same = jnp.ones(len(fitness))
    none = jnp.zeros((len(fitness), 0))
    return Predicted(none, fitness, error * same, feasible * same, jnp.asarray(cell), none)


def test_expected_gain_is_the_mean_of_improvements():
    """Beside the mean over a million draws."""
    found = predicted([0.3, 0.5, 1.0], [0, 0, 0], feasible=0.7, error=0.2)
    gain = np.asarray(expected_gain(found, jnp.full(3, 0.5)))
    draws = np.random.default_rng(0).normal(size=1_000_000)
    sampled = [0.7 * np.maximum(mean + 0.2 * draws - 0.5, 0).mean() for mean in (0.3, 0.5, 1.0)]
    np.testing.assert_allclose(gain, sampled, rtol=2e-2)


def test_choices_spread_over_cells_before_they_repeat_one():
    found = predicted([1.0, 0.99, 0.98, 0.5, 0.4], [0, 0, 0, 1, 2], error=0.01)
    chosen, height = best(found, jnp.zeros(4), jnp.ones(5, bool), 3, 3)
    assert chosen.tolist() == [0, 3, 4]
    np.testing.assert_allclose(height, [1.0, 0.5, 0.4, 0.0], atol=1e-6)


@pytest.mark.parametrize(("fitness", "empty"), [([0.5, 0.2], 0.0), ([-3.0, -1.0], -3.0)])
def test_empty_cells_are_worth_filling_whatever_the_sign_of_fitness(fitness, empty):
    elites = search.no_elites(4, 1, Vector(jnp.zeros(1)))
    place = jnp.array([1, 2])
    elites = replace(
        elites,
        occupied=elites.occupied.at[place].set(True),
        fitness=elites.fitness.at[place].set(jnp.array(fitness)),
    )
    np.testing.assert_allclose(heights(elites), [empty, *fitness, empty])
