"""Tests, effect sizes and means equal SciPy's, textbooks' examples and their definitions."""

from itertools import combinations
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from microcosmos.statistics.effects import (
    Bootstrap,
    holm,
    kruskal_wallis,
    mann_whitney,
    middle_mean,
    quartiles,
    superiority,
)

TERM = np.array([0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46])
EARLIER = np.array([1.15, 0.88, 0.90, 0.74, 1.21])
"""Permeability of the human chorioamnion at term and at 12 to 26 weeks: Hollander and Wolfe,
Nonparametric Statistical Methods (1973), p. 69; the example of R's `wilcox.test`."""

CLEARANCE = (
    np.array([2.9, 3.0, 2.5, 2.6, 3.2]),
    np.array([3.8, 2.7, 4.0, 2.4]),
    np.array([2.8, 3.4, 3.7, 2.2, 2.0]),
)
"""Mucociliary efficiency of three groups: Hollander and Wolfe (1973), p. 115; the example of
R's `kruskal.test`."""

VALUES = st.lists(st.integers(-20, 20), min_size=2, max_size=9).map(
    lambda numbers: np.array(numbers, float)
)


def test_mann_whitney_gives_the_numbers_of_hollander_and_wolfe():
    found = mann_whitney(TERM, EARLIER)
    assert found.name == "Mann–Whitney, exact"
    assert found.statistic == 35
    assert found.p / 2 == pytest.approx(0.1272, abs=5e-5)  # R prints the one-sided p.


def test_kruskal_wallis_gives_the_numbers_of_hollander_and_wolfe():
    found = kruskal_wallis(CLEARANCE)
    assert found.statistic == pytest.approx(0.7714, abs=5e-5)
    assert found.p == pytest.approx(0.68, abs=5e-3)


def test_holm_rejects_what_holm_does():
    """Levels α/4, α/3, α/2, α one after the other: the textbook's 0.005, 0.01 | 0.03, 0.04."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_the_mean_of_the_middle_half_leaves_out_a_quarter_at_either_end():
    values = np.array([100.0, 1, 2, 3, 4, 5, 6, -100])
    assert middle_mean(values) == np.mean([2, 3, 4, 5])
    several = [np.array([0.0, 8.0]), np.array([2.0, 4.0])]
    assert middle_mean(*several) == 3.0, "over runs of all tasks together, as in rliable"


def test_intervals_are_those_of_scipy_and_of_their_seed():
    bootstrap = Bootstrap(resamples=499, seed=3)
    found = bootstrap.interval([TERM], middle_mean)
    expected = stats.bootstrap(
        (TERM,),
        lambda x, axis: stats.trim_mean(x, 0.25, axis=axis),
        n_resamples=499,
        method="percentile",
        rng=np.random.default_rng(3),
    ).confidence_interval
    assert found == pytest.approx((expected.low, expected.high))
    assert found == bootstrap.interval([TERM], middle_mean)
    assert found != Bootstrap(499, 4).interval([TERM], middle_mean)


@pytest.mark.long
@given(VALUES, VALUES)
def test_superiority_is_u_per_pair_and_adds_up_to_one(ours, theirs):
    share = superiority(ours, theirs)
    statistic = mann_whitney(ours, theirs).statistic
    assert share == pytest.approx(statistic / (len(ours) * len(theirs)))
    assert share + superiority(theirs, ours) == pytest.approx(1)


@given(VALUES, VALUES)
def test_p_is_scipys_and_no_order_of_groups_changes_it(ours, theirs):
    found = mann_whitney(ours, theirs)
    assert 0 <= found.p <= 1
    assert found.p == pytest.approx(mann_whitney(theirs, ours).p)
    method = found.name.partition(", ")[2]
    if method in ("exact", "asymptotic"):
        assert found.p == stats.mannwhitneyu(ours, theirs, method=method).pvalue


@pytest.mark.parametrize(
    ("ours", "theirs", "p"),
    [
        ([1] * 5, [2] * 5, 2 / 252),
        ([1] * 5, [1, 2, 2, 2, 2], 12 / 252),
        ([1, 1, 2], [1, 2, 3, 3, 3], 14 / 56),
    ],
)
def test_p_of_small_tied_groups_is_that_of_counting_by_hand(ours, theirs, p):
    """1 and 6 of 252 ways to choose five runs, 7 of 56 to choose three, are as extreme."""
    found = mann_whitney(np.array(ours, float), np.array(theirs, float))
    assert found.name == "Mann–Whitney, exact with ties"
    assert found.p == pytest.approx(p, rel=1e-12)


def test_p_of_many_ties_is_exact_in_groups_of_twelve():
    """Times on a rotarod that ends after 300 s, as in Bergmann, Ludbrook and Spooren (2000).

    Of 24 rats the five that fall are all in one group: 2 C(12, 5) / C(24, 5) = 0.0373; the
    normal approximation gives 0.0165.
    """
    ours, theirs = np.full(12, 300.0), np.array([300.0] * 7 + [22, 75, 190, 240, 262])
    found = mann_whitney(ours, theirs)
    assert found.name == "Mann–Whitney, exact with ties"
    assert found.p == pytest.approx(2 * comb(12, 5) / comb(24, 5), rel=1e-12)
    assert round(stats.mannwhitneyu(ours, theirs, method="asymptotic").pvalue, 4) == 0.0165


TIED = st.lists(st.integers(0, 3), min_size=2, max_size=6).map(
    lambda numbers: np.array(numbers, float)
)


@settings(max_examples=40)
@given(TIED, TIED)
def test_p_of_tied_groups_is_that_of_every_way_to_divide_them(ours, theirs):
    """Twice the smaller tail of U, also by SciPy's permutation test, which tries every way."""
    found = mann_whitney(ours, theirs)
    together = np.concatenate([ours, theirs])
    divided = []
    for chosen in combinations(range(len(together)), len(ours)):
        rest = np.delete(together, chosen)
        divided.append(superiority(together[list(chosen)], rest) * ours.size * theirs.size)
    found_u, u = round(2 * found.statistic), np.rint(2 * np.array(divided))
    tail = min((u <= found_u).mean(), (u >= found_u).mean())
    if "exact" in found.name:
        assert found.p == pytest.approx(min(1, 2 * tail))
        method = stats.PermutationMethod(n_resamples=1000, rng=np.random.default_rng(0))
        assert found.p == pytest.approx(stats.mannwhitneyu(ours, theirs, method=method).pvalue)


@given(st.lists(VALUES, min_size=3, max_size=5))
def test_h_is_scipys_and_of_ranks_alone(groups):
    found = kruskal_wallis(groups)
    if np.ptp(np.concatenate(groups)) > 0:
        expected = stats.kruskal(*groups)
        assert found.statistic == pytest.approx(expected.statistic)
        assert found.p == pytest.approx(expected.pvalue)
    else:
        assert found.p == 1
    assert kruskal_wallis([np.exp(one / 9) for one in groups]).p == pytest.approx(found.p)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_lies_between_no_correction_and_bonferronis(p):
    found, given_p = np.array(holm(p)), np.array(p)
    assert (found >= given_p).all()
    assert (found <= np.minimum(1, len(p) * given_p)).all()
    assert (np.diff(found[np.argsort(given_p, kind="stable")]) >= 0).all()


@given(VALUES)
def test_quartiles_are_numpys(values):
    assert quartiles(values) == pytest.approx(tuple(np.quantile(values, (0.25, 0.5, 0.75))))


def test_a_run_that_never_arrives_is_later_than_all_others():
    times = np.array([30.0, np.inf, 10.0, 20.0, np.inf])
    assert quartiles(times) == (20.0, 30.0, np.inf)
    assert superiority(times, np.array([25.0])) == 3 / 5
    assert mann_whitney(times, np.array([np.inf] * 5)).p < 1


def test_an_archive_without_elites_is_worse_than_all_others():
    best = np.array([-30.0, -np.inf, -10.0, -20.0, -np.inf])
    assert quartiles(best) == (-np.inf, -30.0, -20.0)
    assert superiority(best, np.array([-25.0])) == 2 / 5


def test_a_mean_of_the_middle_half_is_finite_where_the_middle_half_is():
    late = np.array([200.0] * 7 + [np.inf])
    assert middle_mean(late) == 200
    assert middle_mean(np.array([1.0, 2, 3, np.inf, np.inf])) == np.inf
    low, high = Bootstrap(499).interval([late], middle_mean)
    assert (low, high) == (200, np.inf), "three of eight are drawn late often enough"
