"""Archives without elites, and sums of negative fitness, mislead nobody."""

import numpy as np
import pytest

from microcosmos.statistics import compare, named, tables
from microcosmos.statistics.effects import Bootstrap
from microcosmos.statistics.measures import Measure

WORSE, BETTER = [-90.0, -80, -70, -60, -95], [-30.0, -20, -10]
FEW = Bootstrap(199)
EMPTY = {name: np.zeros(4) for name in ("coverage", "best", "mean", "qd_score")}
"""Curves of a run without elites, as files have them."""


@pytest.fixture
def costs(run):
    """Groups with fitness below 0; the second has two archives without elites."""

    def make(best, seed):
        curves = {name: np.full(4, best) for name in ("best", "mean", "qd_score")}
        return run(best, seed=seed, curves=curves)

    empty = [run(0.0, seed=seed, curves=EMPTY) for seed in (5, 6)]
    worse = [make(best, seed) for seed, best in enumerate(WORSE)]
    better = [make(best, seed) for seed, best in enumerate(BETTER)]
    return named({"worse": worse, "better": better + empty})


def test_the_best_of_an_archive_without_elites_beats_none(costs):
    (result,) = compare(costs, ["best"], FEW).results
    assert result.summaries[1].values == (*BETTER, -np.inf, -np.inf)
    # 15 pairs with elites, all won by the second group; 10 pairs that it loses.
    assert result.pairs[0].superiority == 10 / 25
    assert result.summaries[1].low == -np.inf
    assert result.summaries[1].median == -30


@pytest.mark.parametrize("text", ["best>=-50", "mean>=-50"])
def test_an_archive_without_elites_reaches_nothing(run, text):
    assert Measure.parse(text).of(run(curves=EMPTY)) == np.inf
    later = np.array([0, 0, 0.1, 0.1])
    fitness = {name: np.array([0.0, 0, -40, -30]) for name in ("best", "mean")}
    assert Measure.parse(text).of(run(curves={"coverage": later, **fitness})) == 30
    assert Measure.parse("best@20").of(run(curves={"coverage": later, **fitness})) == -np.inf


def test_sums_of_negative_fitness_have_a_caution(costs, group_of):
    caution = "Some runs have negative fitness. A QD score adds up fitness"
    assert caution in tables.text(compare(costs, ["qd_score"], FEW))
    assert caution not in tables.text(compare(costs, ["best", "coverage"], FEW))
    assert caution not in tables.text(compare(named({"a": group_of([1.0] * 5)})))


def test_an_interquartile_mean_is_finite_where_one_run_of_eight_is_late(group_of):
    groups = named({"a": group_of([4.0] * 7 + [1.0]), "b": group_of([8.0] * 8)})
    (result,) = compare(groups, ["qd_score>=3"], FEW).results
    assert result.summaries[0].values == (30,) * 7 + (np.inf,)
    assert result.summaries[0].middle_mean == 30
    assert result.summaries[0].interval is None, "more than 1 in 40 resamples have three late"
    assert result.summaries[1].interval == (20, 20)
