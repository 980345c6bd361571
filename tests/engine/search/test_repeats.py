"""Repeated evaluations add up to means and spreads; a corrected archive is made of them."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.genomes import Vector
from microcosmos.search import reevaluation

CELLS = 4


@pytest.fixture
def cells(one_axis):
    return one_axis(CELLS)


@pytest.fixture
def found():
    """A function that makes evaluations, a row for each cell."""

    def make(fitness, measure, status=(0, 0, 0, 0)):
        return search.Evaluation(
            jnp.asarray(fitness, jnp.float32),
            jnp.asarray(measure, jnp.float32)[:, None],
            jnp.asarray(status),
        )

    return make


def test_means_and_spreads_are_those_of_all_samples(cells, found):
    random = np.random.default_rng(0)
    samples = random.normal(2.0, 1.0, (20, CELLS)).astype(np.float32)
    repeats = reevaluation.no_repeats(CELLS, 1)
    done = jnp.asarray([True, True, True, False])
    for row in samples:
        repeats = reevaluation.add(repeats, done, found(row, row / 8), cells)
    assert repeats.count.tolist() == [20, 20, 20, 0]
    np.testing.assert_allclose(repeats.fitness[:3], samples.mean(0)[:3], rtol=1e-5)
    spread = np.sqrt(np.asarray(repeats.squares)[:3] / 19)
    np.testing.assert_allclose(spread, samples.std(0, ddof=1)[:3], rtol=1e-5)
    assert repeats.fitness[3] == 0


def test_what_diverged_is_counted_and_in_no_mean(cells, found):
    repeats = reevaluation.no_repeats(CELLS, 1)
    done = jnp.ones(CELLS, bool)
    repeats = reevaluation.add(repeats, done, found([1.0, 1, 1, 1], [0.1] * 4), cells)
    bad = found([np.nan, np.inf, 3.0, 1.0], [np.nan, np.inf, 0.3, 0.1], (1, 1, 0, 0))
    repeats = reevaluation.add(repeats, done, bad, cells)
    assert repeats.failed.tolist() == [1, 1, 0, 0]
    np.testing.assert_allclose(repeats.fitness, [1, 1, 2, 1])
    np.testing.assert_allclose(repeats.measures[:, 0], [0.1, 0.1, 0.2, 0.1], rtol=1e-6)


def test_a_hit_is_a_repeat_in_the_elites_own_cell(cells, found):
    repeats = reevaluation.no_repeats(CELLS, 1)
    done = jnp.ones(CELLS, bool)
    for measure in ([0.1, 0.3, 0.6, 0.9], [0.1, 0.1, 0.6, 0.6]):
        repeats = reevaluation.add(repeats, done, found([1.0] * 4, measure), cells)
    assert repeats.hits.tolist() == [2, 1, 2, 1]


def test_a_new_elite_begins_anew(cells, found):
    repeats = reevaluation.no_repeats(CELLS, 1)
    done = jnp.ones(CELLS, bool)
    repeats = reevaluation.add(repeats, done, found([1.0, 2, 3, 4], [0.1] * 4), cells)
    entered = jnp.asarray([True, False])
    repeats = reevaluation.forget(repeats, jnp.asarray([2, 0]), entered)
    assert repeats.count.tolist() == [1, 1, 0, 1]
    assert repeats.fitness.tolist() == [1, 2, 0, 4]


def test_the_corrected_archive_holds_the_best_mean_of_each_cell(cells, found):
    repeats = reevaluation.no_repeats(CELLS, 1)
    done = jnp.asarray([True, True, True, False])
    # The elites of cells 0 and 1 really belong into cell 2, where one of them is better.
    values = found([5.0, 4.0, 1.0, 9.0], [0.6, 0.6, 0.6, 0.1])
    repeats = reevaluation.add(repeats, done, values, cells)
    elites = search.no_elites(CELLS, 1, Vector(jnp.zeros(1)))
    elites = search.Elites(**{**vars(elites), "occupied": jnp.ones(CELLS, bool)})
    corrected = reevaluation.corrected(elites, repeats, cells)
    np.testing.assert_array_equal(corrected, [np.nan, np.nan, 5.0, np.nan])
