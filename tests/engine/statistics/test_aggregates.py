"""Aggregates over tasks follow Agarwal et al. (2021)."""

import json

import numpy as np
import pytest

from microcosmos.statistics import across, named, tables
from microcosmos.statistics.effects import Bootstrap, middle_mean, superiority

TASK = ["world.viscosity"]
BASE = ([1.0, 2, 3, 4, 5], [10.0, 20, 30, 40, 50])
OTHER = ([3.0, 6, 2, 8, 9], [30.0, 25, 90, 70, 10])
FEW = Bootstrap(299)


@pytest.fixture
def groups(group_of):
    def of(scores, width):
        thin, thick = scores
        wide = {"world__width": width}
        return group_of(thin, **wide) + group_of(thick, world__viscosity=0.2, **wide)

    return named({"base": of(BASE, 96), "other": of(OTHER, 128)})


def test_the_interquartile_mean_is_over_all_runs_relative_to_the_first_group(groups):
    found = across(groups, "qd_score", TASK, FEW)
    together = np.sort(np.concatenate([np.divide(OTHER[0], 3), np.divide(OTHER[1], 30)]))
    assert found.groups[1].middle_mean == pytest.approx(together[2:-2].mean())
    low, high = found.groups[1].interval
    assert low < found.groups[1].middle_mean < high
    assert [task["world.viscosity"] for task in found.tasks] == [0.05, 0.2]


def test_the_probability_of_improvement_is_the_mean_over_tasks(groups):
    (found,) = across(groups, "qd_score", TASK, FEW).improvements
    shares = [
        np.mean([(x > y) + 0.5 * (x == y) for x in base for y in other])
        for base, other in zip(BASE, OTHER, strict=True)
    ]
    assert found.probability == pytest.approx(np.mean(shares))
    assert found.interval[0] <= found.probability <= found.interval[1]


def test_a_performance_profile_is_the_share_of_runs_above_a_score(groups):
    found = across(groups, "qd_score", TASK, FEW)
    scores = np.concatenate([np.divide(BASE[0], 3), np.divide(BASE[1], 30)])
    for score, share in zip(found.scores, found.groups[0].profile, strict=True):
        assert share == pytest.approx(np.mean(scores > score))
    low, high = np.array(found.groups[0].band)
    profile = np.array(found.groups[0].profile)
    assert ((low <= profile) & (profile <= high)).all()
    assert found.groups[1].profile[-1] == 0, "no run is above the greatest score"


def test_tasks_that_a_group_lacks_are_refused(groups, group_of):
    lacking = named({"a": groups[0].runs, "b": group_of(OTHER[0], world__width=128)})
    with pytest.raises(ValueError, match="every group needs the same tasks"):
        across(lacking, "qd_score", TASK, FEW)
    fewer = named({"a": groups[0].runs[:-1]})
    with pytest.raises(ValueError, match="as many runs of every task, got 5, 4"):
        across(fewer, "qd_score", TASK, FEW)


def test_tasks_may_be_lists(run):
    """`search.initial` is a list in every spec, and lists have no hash."""
    runs = [run(float(seed + 1), seed=seed) for seed in range(5)]
    found = across(named({"a": runs}), "qd_score", ["search.initial"], FEW)
    assert found.tasks == ({"search.initial": []},)
    assert "Over 1 task (search.initial" in tables.aggregates_text([found])


def test_numbers_of_tasks_are_equal_in_any_form(run):
    def made(width, best):
        found = [run(best, seed=seed) for seed in range(5)]
        for one in found:
            one.fields["world.width"] = width
        return found

    runs = {"a": made(96, 1.0), "b": made(96.0, 2.0)}
    (task,) = across(named(runs), "best", ["world.width"], FEW).tasks
    assert task == {"world.width": 96}


def test_a_run_without_elites_has_no_score(run, group_of):
    empty = run(0.0, seed=5, curves={"coverage": np.zeros(4)})
    groups = named({"a": group_of([1.0] * 5), "b": [*group_of([2.0] * 4), empty]})
    with pytest.raises(ValueError, match=r"needs elites in every run, got none in 0-seed5\.h5"):
        across(groups, "best", TASK, FEW)


def test_fewer_than_five_seeds_of_a_task_have_no_interval(group_of):
    few = named({"a": group_of([1.0, 2, 3])})
    found = across(few, "qd_score", TASK, FEW)
    assert (found.groups[0].interval, found.groups[0].band) == (None, None)
    assert found.refusal.endswith("got 3 in 'a'.")


def test_text_and_json_state_tasks_and_method(groups):
    found = [across(groups, "qd_score", TASK, FEW)]
    assert "world.viscosity 0.05, world.viscosity 0.2" in tables.aggregates_text(found)
    (document,) = json.loads(tables.aggregates_json(found))
    assert document["groups"][0]["runs"] == 10


def test_means_and_probabilities_are_those_of_rliable():
    metrics = pytest.importorskip("rliable.metrics", reason="make peers installs rliable")
    ours, theirs = np.random.default_rng(0).random((2, 7, 4))
    assert middle_mean(*ours.T) == pytest.approx(metrics.aggregate_iqm(ours))
    shares = [superiority(x, y) for x, y in zip(ours.T, theirs.T, strict=True)]
    expected = metrics.probability_of_improvement(ours, theirs)
    assert np.mean(shares) == pytest.approx(expected)
