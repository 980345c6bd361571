"""Searches that evaluate their elites again are compared at equal moments of the search."""

import json

import numpy as np
import pytest

from microcosmos.statistics import across, compare, named, tables
from microcosmos.statistics.effects import Bootstrap
from microcosmos.statistics.measures import Measure

EVERY, SAMPLES, BATCH = 25, 4, 64
FEW = Bootstrap(99)


@pytest.fixture
def searches(run):
    """A function that makes five runs which evaluate their elites again on schedule and at the
    end; scores grow evenly by `pace` in each generation."""

    def make(elites=400, pace=1.0, generations=50, every=EVERY, per_generation=BATCH, **fields):
        along = np.arange(1, generations + 1)
        again = (along % every == 0) | (along == generations)
        found = []
        for seed in range(5):
            spent = np.cumsum(np.where(again, SAMPLES * (elites + seed), 0))
            curves = {"evaluations": per_generation * along + spent, "qd_score": pace * along}
            corrected = np.where(again, 0.9 * pace * along, np.nan)
            curves |= {name: corrected for name in ("corrected_qd_score", "corrected_coverage")}
            settings = {"search__reevaluation": {"every": every, "samples": SAMPLES}}
            parts = {"generations": generations, "batch": BATCH, "curves": curves, "seed": seed}
            name = f"{elites}-{generations}-{seed}.h5"
            found.append(run(name=name, **parts, **settings, **fields))
        return found

    return make


@pytest.fixture
def better(searches):
    """Two searches, of which the first, with more elites, is ahead in every generation."""
    ours = searches(elites=400, pace=1.2)
    return named({"a": ours, "b": searches(elites=390, world__viscosity=0.2)})


@pytest.fixture
def shorter(searches):
    """One search, of 45 and of 50 generations."""
    return named({"45": searches(generations=45), "50": searches(search__generations=50)})


def superiority(groups, measure):
    (result,) = compare(groups, [measure], FEW).results
    return result.pairs[0].superiority


def test_evaluations_of_elites_again_are_not_counted(searches, run):
    expected = BATCH * np.arange(1, 51)
    for every in (1, 7, 25, 100):
        for one in searches(every=every):
            np.testing.assert_array_equal(one.searched, expected)
    plain = run(generations=3, batch=8)
    np.testing.assert_array_equal(plain.searched, [8, 16, 24])


@pytest.mark.parametrize("every", [1, 25])
def test_gradients_are_counted(searches, every):
    """Each of two emitters needs one gradient in a generation."""
    emitters = [{"operator": "cma-mega"}, {"operator": "cma-mega"}]
    made = searches(every=every, per_generation=BATCH + 2, search__emitters=emitters,
                    control={"encoding": "direct"})  # fmt: skip
    for one in made:
        np.testing.assert_array_equal(one.searched, (BATCH + 2) * np.arange(1, 51))


@pytest.mark.parametrize(
    "measure", ["qd_score", "corrected_qd_score", "corrected_coverage", "qd_score@3200"]
)
def test_final_values_of_equal_searches_are_compared(better, measure):
    """All made 50 generations; those with more elites made more evaluations."""
    assert superiority(better, measure) == 1


def test_the_search_that_is_ahead_is_ahead_at_every_number_and_value(better):
    for at in range(BATCH * EVERY, 50 * BATCH + 1, 40):
        assert superiority(better, f"corrected_qd_score@{at}") == 1
        assert superiority(better, f"qd_score@{at}") == 1
    # Where both exceed it with the first number, they are as early.
    reached = [superiority(better, f"corrected_qd_score>={x}") for x in (20, 24, 40, 48, 60)]
    assert reached == [0.5, 0, 0.5, 0, 0.5]
    assert superiority(better, "qd_score>=30") == 0, "fewer evaluations"


def test_an_early_end_puts_no_search_ahead(shorter):
    """The shorter one shows its last generation when the other shows one of the schedule."""
    message = (
        r"`corrected_qd_score` needs .* got 2,880 in .*; compare at corrected_qd_score@1600$"
    )
    refused(shorter, "corrected_qd_score", message)
    message = (
        r"after 1,600 in 400-50-0\.h5 and after 2,880 in 400-45-0\.h5; compare at .*@1600$"
    )
    refused(shorter, "corrected_qd_score@2880", message)
    message = r"got one after 2,880 in 400-45-0\.h5 and none there in 400-50-0\.h5"
    refused(shorter, "corrected_qd_score>=30", message)
    for measure in ("corrected_qd_score@1600", "corrected_qd_score@2000", "qd_score@2880"):
        assert superiority(shorter, measure) == 0.5
    assert superiority(shorter, "corrected_qd_score>=20") == 0.5, "both after 1,600"


def test_searches_that_never_had_values_together_have_no_advice(searches):
    groups = named({"20": searches(generations=20), "50": searches(search__generations=50)})
    refused(groups, "corrected_qd_score", r"3,200 in 400-50-0\.h5$")


def refused(groups, measure, message):
    with pytest.raises(ValueError, match=message):
        compare(groups, [measure], FEW)


def test_tasks_are_compared_at_equal_moments(better, shorter, searches):
    task = ["world.width"]

    def improvement(groups, measure):
        return across(groups, measure, task, FEW).improvements[0].probability

    for measure in ("corrected_qd_score", "corrected_qd_score@1700", "qd_score"):
        assert improvement(better, measure) == 1
    for measure in ("corrected_qd_score", "corrected_qd_score@2880"):
        with pytest.raises(ValueError, match="compare at corrected_qd_score@1600"):
            across(shorter, measure, task, FEW)


def test_what_numbers_leave_out_is_said(better, group_of):
    said = "Evaluations of elites again (`search.reevaluation`) are not counted."
    text = tables.text(compare(better, ["qd_score@3200"], FEW))
    assert said in text.replace("\n", " ")
    (found,) = json.loads(
        tables.aggregates_json([across(better, "qd_score@3200", ["world.width"], FEW)])
    )
    assert said in found["cautions"]
    assert said not in tables.text(compare(better, ["qd_score"], FEW))
    plain = named({"a": group_of([1.0] * 5)})
    assert said not in tables.text(compare(plain, ["qd_score@40"], FEW))


def test_a_number_beyond_the_search_is_refused_though_there_are_more_evaluations(searches):
    (one, *_) = searches()
    assert one.evaluations[-1] > 3300
    with pytest.raises(ValueError, match=r"without those of elites again\) from 64, its first"):
        Measure.parse("qd_score@3300").of(one)
